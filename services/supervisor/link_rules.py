"""What must hold of the links: no faults under a bound identity, one publisher a topic, one experiment, answers in time."""

from hydrohil.services.supervisor.rule import Limits, Observed, Rule
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.deadline_window import quality
from hydrohil.shared.contract.messages import TripCause


@kernel
def links_sound(seen: Observed, limits: Limits) -> bool:
    return seen.transport.link_faults <= limits.faults_per_s


@kernel
def one_publisher(seen: Observed, limits: Limits) -> bool:
    return seen.transport.epoch_conflicts <= _epoch_conflicts_allowed(seen, limits)


@kernel
def _epoch_conflicts_allowed(seen: Observed, limits: Limits) -> int:
    """At rest a service may start anew; in motion nobody may."""
    return 0 if seen.moving else limits.faults_per_s


@kernel
def one_experiment(seen: Observed, limits: Limits) -> bool:
    return seen.transport.other_run == 0


@kernel
def answered_in_time(seen: Observed, limits: Limits) -> bool:
    return seen.transport.missed <= limits.missed_samples


LINK_RULES = (
    Rule(
        links_sound,
        TripCause.LINK_FAULTS,
        lambda seen, _: float(seen.transport.link_faults),
        lambda _, limits: float(limits.faults_per_s),
    ),
    Rule(
        one_publisher,
        TripCause.TWO_PUBLISHERS,
        lambda seen, _: float(seen.transport.epoch_conflicts),
        lambda seen, limits: float(_epoch_conflicts_allowed(seen, limits)),
    ),
    Rule(
        one_experiment,
        TripCause.OTHER_RUN,
        lambda seen, _: float(seen.transport.other_run),
        lambda _, __: 0.0,
    ),
    Rule(
        answered_in_time,
        TripCause.QUALITY,
        lambda seen, _: quality(seen.transport.missed),
        lambda _, limits: quality(limits.missed_samples),
    ),
)
