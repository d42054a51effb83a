"""All measurements at one rate, one after the other, so that none disturbs another."""

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


class Settings(NamedTuple):
    """How long, where, and in which scheduling class to measure."""

    place: Place
    seconds: float  # of the loop's trial
    baseline_s: float  # of each measurement before it
    realtime: bool


class Measured(NamedTuple):
    """The figures of a rate, and what the host granted while they were measured."""

    figures: Figures
    granted: dict[str, bool]


def measure(settings: Settings, period_substeps: int, progress: Callable[[str, float], object]) -> Measured:
    """One rate. `progress` gets the step under way and the seconds that have passed. Raises CellError."""
    period_ns = period_substeps * SUBSTEP_NS
    baseline = probe.Settings(settings.place, period_ns, settings.baseline_s, settings.realtime)
    progress("wake-ups", 0.0)
    woken = probe.wake_ups(baseline)
    progress("the machine's own limit", settings.baseline_s)
    limit = probe.limit(baseline)
    progress("ping-pong", 2 * settings.baseline_s)
    pinged = probe.ping(baseline)
    baselines_s = STEPS * settings.baseline_s
    progress("the loop: a cell comes up", baselines_s)
    figures = baseline_figures(period_ns, woken["us"], limit, pinged)
    options = [] if settings.realtime else ["--no-realtime"]
    figures = loop(
        settings.place,
        settings.seconds,
        period_substeps,
        options=options,
        progress=lambda trial_s: progress("the loop", baselines_s + max(0.0, trial_s)),
        figures=figures,
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
