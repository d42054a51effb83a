"""The full loop at a rate: a private cell of plant, controller and supervisor, and a trial without contact in it."""

import math
from collections.abc import Callable, Mapping
from typing import Any

from hydrohil.cell import processes as cells
from hydrohil.cell.session import run_live
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.overrides import with_overrides
from hydrohil.qualification.grading import Figures
from hydrohil.qualification.samples import Timing, timing, worst_window
from hydrohil.qualification.spread import Spread, spread
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.host.lease import MAX_LEASE_NS
from hydrohil.simulation.rollout import duration_ticks
from hydrohil.thesis.library import find

EXPERIMENT = "fig-4-25"  # a sine in free space, all the way through the law
_DEPTH = 1 << 20  # frames; 17 minutes at 1 kHz
_LONGEST_LEASE = ["--permit-ttl-ms", str(MAX_LEASE_NS // 1_000_000)]  # a stall is to be measured; it must not end the trial


def settings(seconds: float, period_substeps: int) -> list[str]:
    """Changes by which the sine lasts for `seconds` at this sampling period."""
    return [
        f"duration_s={float(seconds)}",
        f"reference.0.duration_s={float(seconds)}",
        "reference.0.amount_end=0.0",
        "claims=[]",
        f"plant.sample_period_substeps={period_substeps}",
        "plant.jitter_substeps=0",
    ]


def trial_of(seconds: float, period_substeps: int) -> Experiment:
    """The sine for `seconds` at this sampling period, without jitter and claims."""
    return with_overrides(find(EXPERIMENT), settings(seconds, period_substeps))


def loop(
    place: cells.Place,
    seconds: float,
    period_substeps: int,
    *,
    options: list[str],
    progress: Callable[[float], object],
    figures: Figures,
) -> Figures:
    """`figures` with those of the loop. Raises CellError where no cell comes up: that says nothing of the host."""
    experiment = trial_of(seconds, period_substeps)
    extra = {service: options for service in cells.LOOP} | {"plant": [*options, *_LONGEST_LEASE]}
    started = cells.start(place, cells.LOOP, with_parent=True, extra=extra)
    try:
        with cells.operator_bus(place) as bus:
            cells.await_ready(place, bus, started)
            samples = bus.subscribe("plant/sample", _DEPTH)
            try:
                live = run_live(bus, experiment, 0, "real", progress, unqualified=True)
                ended, status = live.tripped or live.gap, live.status
            except cells.CellError as error:
                ended, status = str(error), cells.statuses(bus, cells.LOOP)
            received = [message.body for message in samples.drain() if isinstance(message, Received)]
    finally:
        cells.stop(process.pid for process in started.values())
    return loop_figures(figures, ended, timing(received, duration_ticks(experiment.duration_s, experiment.plant)), status)


def loop_figures(figures: Figures, ended: str, observed: Timing, status: Mapping[str, Mapping[str, Any]]) -> Figures:
    """`figures` with those of the samples and of the services' counters; NaN of a service that does not answer."""
    counters: Mapping[str, Any] = status.get("plant", {}).get("counters", {})
    late = counters.get("lateness_us") or {}
    answered = all(service in status for service in cells.LOOP)
    lost = sum(
        counts.get("lost", 0) for service in cells.LOOP for counts in status.get(service, {}).get("link_stats", {}).values()
    )
    return figures._replace(
        ended=ended,
        samples=int(counters.get("samples", 0)),
        unanswered=float(counters.get("unanswered", math.nan)),
        shifts=float(counters.get("grid_shifts", math.nan)),
        late_permits=float(counters.get("late_permits", math.nan)),
        lost=float(lost + observed.missing) if answered else math.nan,
        worst_window=worst_window(observed.in_time),
        accepted_us=spread(observed.accepted_us),
        grid_us=Spread(
            p50=late.get("p50", math.nan), p99=late.get("p99", math.nan), max=counters.get("worst_lateness_us", math.nan)
        ),
    )
