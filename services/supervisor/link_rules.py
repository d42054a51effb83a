"""What must hold of the links: no faults under a bound identity, one publisher a topic, one experiment, answers in time."""

from hydrohil.services.supervisor.rule import Limits, Observed, Rule
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.deadline_window import quality
from hydrohil.shared.contract.messages import TripCause


@kernel
def links_sound(observed: Observed, limits: Limits) -> bool:
    return observed.transport.link_faults <= limits.faults_per_s


@kernel
def one_publisher(observed: Observed, limits: Limits) -> bool:
    return observed.transport.epoch_conflicts <= _epoch_conflicts_allowed(observed, limits)


@kernel
def _epoch_conflicts_allowed(observed: Observed, limits: Limits) -> int:
    """At rest a service may be restarted; in motion none may."""
    return 0 if observed.moving else limits.faults_per_s


@kernel
def one_experiment(observed: Observed, limits: Limits) -> bool:
    return observed.transport.other_run == 0


@kernel
def answered_in_time(observed: Observed, limits: Limits) -> bool:
    return observed.transport.missed <= limits.missed_samples


LINK_RULES = (
    Rule(
        holds=links_sound,
        cause=TripCause.LINK_FAULTS,
        measured=lambda observed, _: float(observed.transport.link_faults),
        limit=lambda _, limits: float(limits.faults_per_s),
    ),
    Rule(
        holds=one_publisher,
        cause=TripCause.TWO_PUBLISHERS,
        measured=lambda observed, _: float(observed.transport.epoch_conflicts),
        limit=lambda observed, limits: float(_epoch_conflicts_allowed(observed, limits)),
    ),
    Rule(
        holds=one_experiment,
        cause=TripCause.OTHER_RUN,
        measured=lambda observed, _: float(observed.transport.other_run),
        limit=lambda _, __: 0.0,
    ),
    Rule(
        holds=answered_in_time,
        cause=TripCause.QUALITY,
        measured=lambda observed, _: quality(observed.transport.missed),
        limit=lambda _, limits: quality(limits.missed_samples),
    ),
)
