"""The work of one worker: play a chunk of trials on the local clock and measure them."""

import math
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

from hydrohil.campaign.campaign import Plan, measure_claims
from hydrohil.campaign.trials import Trial, experiment_of, trial_of
from hydrohil.claims.claims import judge
from hydrohil.claims.trace import Trace
from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import Experiment
from hydrohil.shared.compiled.kernel import source_version
from hydrohil.shared.contract.messages import Mode, TripCause
from hydrohil.shared.errors import HydrohilError
from hydrohil.shared.trips.causes import trip_words
from hydrohil.shared.units import NS_PER_S
from hydrohil.simulation.rollout import play_local, trace_of

COMPLETED, TRIPPED, REFUSED = "completed", "tripped", "refused"
WARM_S = 0.1
Row = dict[str, Any]


class Chunk(NamedTuple):
    """Some trials of a plan, to be run by the sources that planned them."""

    plan: Plan
    sources: str
    numbers: tuple[int, ...]


class OtherSourcesError(HydrohilError):
    """The worker's copy of this project is another version."""


@cache
def _sources() -> str:
    return source_version()


def work(chunk: Chunk) -> list[Row]:
    """The rows of a chunk. Raises OtherSourcesError."""
    if _sources() != chunk.sources:
        raise OtherSourcesError(f"its sources are {_sources()}, those here {chunk.sources}")
    return [row(chunk.plan, trial_of(chunk.plan.campaign, number)) for number in chunk.numbers]


def warm(plan: Plan) -> None:
    """Compile, or load compiled kernels: a tenth of a second of the experiment, without its claims and faults."""
    base = plan.base
    play_local(base._replace(duration_s=WARM_S, claims=(), faults=()), 0)


def row(plan: Plan, trial: Trial) -> Row:
    """Play one trial; the row of one that is refused, or trips, says so."""
    known: Row = {"trial": trial.number, "point": trial.point, "repeat": trial.repeat, "seed": trial.seed, **trial.parameters}
    try:
        experiment = experiment_of(plan, trial.parameters)
        outcome = play_local(experiment, trial.seed)
    except (ExperimentError, ValueError) as reason:
        return known | {"ended": REFUSED, "message": str(reason)}
    trip, trace = outcome.supervisor, trace_of(outcome)
    known["end_s"] = float(outcome.rows.time_ns[-1]) / NS_PER_S
    if trip.mode == Mode.TRIPPED:
        cause = TripCause(trip.cause)
        words = trip_words(cause, trip.measured, trip.limit, trip.trip_number)
        return known | measured(plan, trace) | {"ended": TRIPPED, "cause": cause.name.lower(), "message": words}
    return known | measured(plan, trace) | _judged(experiment, trace) | {"ended": COMPLETED}


def measured(plan: Plan, trace: Trace) -> Row:
    """Every metric, None where its window does not determine it: a trial that tripped may not have reached its end."""
    return {claim.statement: _number(judge(claim, trace).measured) for claim in measure_claims(plan.campaign)}


def _judged(experiment: Experiment, trace: Trace) -> Row:
    """Every claim of a trial that completed: what was measured, in the claim's unit, and whether it holds."""
    verdicts = [judge(claim, trace) for claim in experiment.claims]
    numbers = {claim_column(k): _number(verdict.measured) for k, verdict in enumerate(verdicts)}
    return numbers | {holds_column(k): verdict.holds for k, verdict in enumerate(verdicts)}


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def claim_column(number: int) -> str:
    """Column of what was measured for a claim."""
    return f"claims.{number}"


def holds_column(number: int) -> str:
    """Column of whether a claim holds."""
    return f"claims.{number}.holds"


def chunks(numbers: Sequence[int], size: int) -> list[tuple[int, ...]]:
    """`numbers` cut into tuples of `size`."""
    return [tuple(numbers[start : start + size]) for start in range(0, len(numbers), size)]
