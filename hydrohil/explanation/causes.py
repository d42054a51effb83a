"""One cause of a trip or of a cut: what must hold, the default limit, what to do."""

from typing import NamedTuple

from hydrohil.explanation.conditions import LIMITS, ZERO
from hydrohil.explanation.names import find_cause
from hydrohil.services.plant.config import PlantConfig
from hydrohil.services.plant.plant_description import describe
from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.services.supervisor.observe import LinkHealth, SampleContext, observe_step, observer_start
from hydrohil.services.supervisor.params import supervisor_params
from hydrohil.services.supervisor.rule import Limits, Observed
from hydrohil.services.supervisor.rules import RULES
from hydrohil.shared.contract.messages import NO_TRIAL, Sample, TripCause
from hydrohil.shared.trips.causes import CUTS, TRIPS, Cause


class Explanation(NamedTuple):
    """A rule of the supervisor or a condition of the gate, in words; "" for what its table does not say."""

    cause: str
    by: str  # "supervisor" or "gate"
    limit: str  # of a rule: the limit that a cell has by default, with its unit
    must_hold: str
    to_do: str


def explain(cause: str) -> tuple[Explanation, ...]:
    """The supervisor's rule, the gate's condition, or both that have this name; `gate.NAME` is the condition alone.

    Case and dashes of the name do not matter. Raises UnknownNameError, which gives the nearest name.
    """
    trip, cut = find_cause(str(cause))
    found = []
    if trip is not None:
        found.append(_explanation("supervisor", trip.name, default_limit(trip), TRIPS.get(trip)))
    if cut is not None:
        found.append(_explanation("gate", cut.name, "", CUTS.get(cut)))
    return tuple(found)


def _explanation(by: str, cause: str, limit: str, row: Cause | None) -> Explanation:
    holds, remedy = ("", "") if row is None else (row.holds, row.remedy)
    return Explanation(cause=cause, by=by, limit=limit, must_hold=holds, to_do=remedy)


def default_limit(cause: TripCause) -> str:
    """The limit that the rule of `cause` has in a cell by default, with its unit; "" for what is no rule or has no number."""
    found = next((rule for rule in RULES if rule.cause == cause), None)
    unit = TRIPS[cause].unit
    if found is None or not unit:
        return ""
    observed, limits = _at_rest()
    return f"{found.limit(observed, limits):.4g} {unit}"


def _at_rest() -> tuple[Observed, Limits]:
    """A machine that stands level, and the default limits."""
    description = describe(PlantConfig(), LIMITS)
    params = supervisor_params(SupervisorConfig(), description, 0, 0)
    sample = Sample(
        number=1,
        time_ns=0,
        tick=NO_TRIAL,
        trial_time_ns=0,
        encoder_counts=tuple(round((0.0 - c.offset) / c.scale) for c in description.machine.encoders),
        force_counts=10,
        dac_counts=ZERO,
        gate=0,
        gate_cause=0,
        gate_open_samples=0,
        recover_signs=(0, 0, 0),
        command_number=0,
        command_late_substeps=0,
        command_age_ns=0,
    )
    links = LinkHealth(faults=0, epoch_conflicts=0, other_run=0, state_lag=1)
    context = SampleContext(running=False, stale_ns=0, ready=True, links=links)
    return observe_step(observer_start(), params.observer, sample, context)[1], params.limits
