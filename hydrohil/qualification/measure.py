"""Everything that is measured at one rate, one after the other: nothing disturbs what is being measured."""

from collections.abc import Callable
from typing import Any, NamedTuple

from hydrohil.cell.processes import Place
from hydrohil.qualification import probe
from hydrohil.qualification.grading import Figures
from hydrohil.qualification.loop import loop
from hydrohil.qualification.spread import Spread, spread
from hydrohil.shared.host.clock import SLACK_NS
from hydrohil.shared.units import SUBSTEP_NS

_NS_PER_US = 1000
STEPS = 3  # measurements before the loop


class Wish(NamedTuple):
    """How long, where, and in which scheduling class."""

    place: Place
    seconds: float  # of the loop's trial
    baseline_s: float  # of each measurement before it
    realtime: bool


class Measured(NamedTuple):
    """The figures of a rate, and what the host granted while they were measured."""

    figures: Figures
    granted: dict[str, bool]


def measure(wish: Wish, period_substeps: int, show: Callable[[str, float], None]) -> Measured:
    """One rate. `show` gets what is under way and the seconds that are over. Raises CellError."""
    period_ns = period_substeps * SUBSTEP_NS
    asked = probe.Asked(wish.place, period_ns, wish.baseline_s, wish.realtime)
    show("wake-ups", 0.0)
    woken = probe.wake_ups(asked)
    show("the machine's own limit", wish.baseline_s)
    limit = probe.limit(asked)
    show("ping-pong", 2 * wish.baseline_s)
    pinged = probe.ping(asked)
    over_s = STEPS * wish.baseline_s
    show("the loop: a cell comes up", over_s)
    figures = baseline_figures(period_ns, woken["us"], limit, pinged)
    options = [] if wish.realtime else ["--no-realtime"]
    figures = loop(
        wish.place, wish.seconds, period_substeps, options, lambda trial_s: show("the loop", over_s + max(0.0, trial_s)), figures
    )
    return Measured(figures, woken["granted"])


def baseline_figures(period_ns: int, late_us: list[float], limit: dict[str, Any], pinged: dict[str, Any]) -> Figures:
    """What is known before the loop runs."""
    return Figures(
        period_ns,
        wake_ups_us=spread(late_us),
        wake_ups_shifting=float(sum(late > SLACK_NS / _NS_PER_US for late in late_us)),
        wake_ups_skipping=float(sum(late > period_ns / _NS_PER_US for late in late_us)),
        limit_us=Spread(*limit["us"]),
        limit_by=limit["by"],
        ping_us=spread(pinged["us"]),
        ping_lost=float(pinged["lost"]),
    )
