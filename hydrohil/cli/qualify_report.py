"""The tables of `hydrohil qualify`."""

import math
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from hydrohil.qualification.grading import GRADES, Figures, late_share, lease_ns
from hydrohil.qualification.host import Found
from hydrohil.qualification.qualify import Qualification
from hydrohil.qualification.record import RateTrial
from hydrohil.qualification.spread import Spread
from hydrohil.shared.host.qualified import hertz

_US_PER_MS, _NS_PER_US = 1e3, 1e3
_COLOURS = {True: "green", False: "yellow", None: "dim"}


def show(console: Console, result: Qualification) -> None:
    """The host, what was measured, and the verdict on each rate."""
    console.print(_host_table(result.facts))
    console.print(_times_table(result.trials))
    for one in result.trials:
        _show_verdict(console, one)


def _host_table(facts: Sequence[Found]) -> Table:
    table = Table("host", "found", "recommended", title="as found", title_justify="left")
    for fact in facts:
        table.add_row(fact.what, f"[{_COLOURS[fact.good]}]{fact.found}[/]", fact.advice)
    return table


def _times_table(trials: Sequence[RateTrial]) -> Table:
    table = Table(title="measured, ms", title_justify="left")
    for column in ("rate", "what", "p50", "p99", "p99.9", "max", "and"):
        table.add_column(column, justify="right" if column.startswith(("p", "max")) else "left", overflow="fold")
    for one in trials:
        for number, (what, spread, note) in enumerate(rows := _rows(one.figures)):
            rate = hertz(one.figures.period_ns) if number == 0 else ""
            table.add_row(rate, what, *map(_ms, spread), note, end_section=number == len(rows) - 1)
    return table


def _rows(figures: Figures) -> tuple[tuple[str, Spread, str], ...]:
    late = f"{_count(figures.wake_ups_shifting)} later than 0.5 ms, {_count(figures.wake_ups_skipping)} than a period"
    unanswered = f"{_count(figures.unanswered)} of {figures.samples} unanswered at the latch"
    return (
        ("wake-ups, late by", figures.wake_ups_us, late),
        ("the machine's own", figures.limit_us, figures.limit_by),
        ("bare round trip", figures.ping_us, f"{_count(figures.ping_lost)} lost"),
        ("sample -> command", figures.accepted_us, unanswered),
        ("the plant's wake-ups", figures.grid_us, f"{_count(figures.shifts)} later than 0.5 ms"),
    )


def _ms(us: float) -> str:
    return f"{us / _US_PER_MS:.3f}" if math.isfinite(us) else "-"


def _count(number: float) -> str:
    return f"{number:.0f}" if math.isfinite(number) else "-"


def _share(share: float, digits: int) -> str:
    return f"{share:.{digits}%}" if math.isfinite(share) else "-"


def _show_verdict(console: Console, one: RateTrial) -> None:
    figures, verdict = one.figures, one.verdict
    colour = "green" if verdict.qualified else "red"
    numbers = (
        f"{_share(late_share(figures), 2)} late, worst 100 samples {_share(figures.worst_window, 0)} in time, "
        f"{_count(figures.lost)} frames lost, "
        f"lease {_ms(lease_ns(figures) / _NS_PER_US)} ms"
    )
    rate = hertz(figures.period_ns)
    console.print(f"{rate}: [bold {colour}]grade {verdict.grade}[/], {GRADES[verdict.grade]}; {numbers}", highlight=False)
    for reason in verdict.reasons:
        console.print(f"  {reason}", highlight=False, markup=False, soft_wrap=True)
