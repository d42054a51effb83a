"""What a run prints: claims (stated, measured, holds), latencies, how it ended."""

from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from hydrohil.claims.claims import Verdict, band, quantity
from hydrohil.experiment.run import BY_HAND, Run
from hydrohil.shared.contract.faults import words
from hydrohil.shared.trips import formatting
from hydrohil.shared.trips.report import Document


def show(console: Console, run: Run) -> None:
    """The tables."""
    experiment = run.experiment
    console.print(f"[bold]{experiment.name}[/] ({experiment.alias}): {escape(experiment.title)}", highlight=False)
    console.print(
        f"clock {run.clock}, seed {run.seed}, {_duration(run)} in {run.wall_s:.2f} s{_speed(run)}",
        highlight=False,
    )
    for fault in experiment.faults:
        console.print(f"[yellow]broken on purpose[/]: {escape(words(fault))}", highlight=False)
    for line in run.process_faults:
        console.print(f"process fault: {line}", highlight=False, markup=False)
    for change in experiment.changes:
        console.print(f"at {change.at_s:g} s: {', '.join(change.set)}", highlight=False, markup=False)
    for line in run.changed_by_hand:
        console.print(line, highlight=False, soft_wrap=True, markup=False, style="yellow")
    _show_ending(console, run)
    if run.verdicts:
        console.print(claims_table(run.verdicts))
    if run.latencies:
        console.print(latency_table(run.latencies))
    if run.recording:
        line = f"recording: {run.recording}  (hydrohil view {run.recording})"
        console.print(line, highlight=False, soft_wrap=True, markup=False)


def _duration(run: Run) -> str:
    """How long the trial was; of one that tripped, how far it came."""
    whole = f"{run.experiment.duration_s:g} s"
    came_s = (run.trip_report or {}).get("trial_time_s")
    return whole if not run.trip or came_s is None else f"{max(came_s, 0.0):.3g} of {whole}"


def _speed(run: Run) -> str:
    """How many times faster than real time; "" of a trial that did not come to its end."""
    return "" if run.trip else f" ({run.experiment.duration_s / run.wall_s:.3g} times real time)"


def _show_ending(console: Console, run: Run) -> None:
    if run.trip:
        console.print(f"[red bold]TRIPPED[/]: {escape(run.trip)}", highlight=False)
    if run.trip_report is not None:
        show_trip(console, run.trip_report, run.trip_file)
    if run.gap:
        console.print(f"[red bold]NO VERDICT[/]: {escape(run.gap)}; every tick is needed", highlight=False)
    if run.changed_by_hand:
        console.print(f"[red bold]NO VERDICT[/]: {BY_HAND}", highlight=False)


def show_trip(console: Console, document: Document, file: str) -> None:
    """A trip's report, and where its file is."""
    for line in formatting.lines(document):
        console.print(line, highlight=False, soft_wrap=True, markup=False)
    if file:
        console.print(f"trip report: {file}  (hydrohil trip {file})", highlight=False, soft_wrap=True, markup=False)


def claims_table(verdicts: tuple[Verdict, ...]) -> Table:
    """Stated, measured, holds."""
    table = Table(title="claims", title_justify="left")
    for column in ("claim", "stated", "measured", "holds"):
        table.add_column(column, overflow="fold")
    for verdict in verdicts:
        mark = "[green]yes[/]" if verdict.holds else "[red]NO[/]"
        claim = verdict.claim
        table.add_row(escape(claim.statement), band(claim), quantity(verdict.measured, claim.unit, 3), mark)
    return table


def latency_table(latencies: dict[str, Any]) -> Table:
    """Latency and lateness of a live run, in us; counts of what was not in time."""
    table = Table(title="latencies", title_justify="left")
    for column in ("", "p50 us", "p99 us", "max us"):
        table.add_column(column, justify="left" if not column else "right")
    for name, key in (
        ("sample -> command accepted", "sample_to_accepted_us"),
        ("lateness of the plant's wake-ups", "lateness_us"),
    ):
        values = latencies.get(key) or {}
        table.add_row(name, *(f"{values[p]:.0f}" if p in values else "-" for p in ("p50", "p99", "max")))
    for key in ("samples", "late_commands", "unanswered", "late_permits", "grid_shifts"):
        if key in latencies:
            table.add_row(key.replace("_", " "), str(latencies[key]), "", "")
    return table
