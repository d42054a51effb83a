"""What must hold of the messages and of those who send them."""

from hydrohil.services.supervisor.rule import Limits, Observed, Rule
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import GateState, TripCause

_OPEN, _REVOKED = int(GateState.OPEN), int(GateState.REVOKED)


@kernel
def samples_complete(seen: Observed, limits: Limits) -> bool:
    return not seen.moving or 0 <= seen.transport.lost_samples <= limits.lease_samples


@kernel
def samples_fresh(seen: Observed, limits: Limits) -> bool:
    return seen.transport.stale_ns <= limits.lease_ns


@kernel
def commands_fresh(seen: Observed, limits: Limits) -> bool:
    return not (seen.moving and seen.tick > 0) or 0 <= seen.transport.command_lag <= limits.lease_samples + 1


@kernel
def controller_heard(seen: Observed, limits: Limits) -> bool:
    return not (seen.moving and seen.tick > 0) or -limits.lease_samples <= seen.transport.state_lag <= limits.lease_samples + 2


@kernel
def gate_holds(seen: Observed, limits: Limits) -> bool:
    return not seen.moving or seen.transport.gate != _REVOKED


@kernel
def controller_ready(seen: Observed, limits: Limits) -> bool:
    return not seen.starting or seen.transport.ready


TRANSPORT_RULES = (
    Rule(
        samples_complete,
        TripCause.SAMPLE_LOST,
        lambda seen, _: float(seen.transport.lost_samples),
        lambda seen, limits: float(limits.lease_samples if seen.transport.lost_samples >= 0 else 0),
    ),
    Rule(
        samples_fresh,
        TripCause.SAMPLE_STALE,
        lambda seen, _: seen.transport.stale_ns * 1e-9,
        lambda _, limits: limits.lease_ns * 1e-9,
    ),
    Rule(
        commands_fresh,
        TripCause.COMMAND_STALE,
        lambda seen, _: float(seen.transport.command_lag),
        lambda seen, limits: float(limits.lease_samples + 1 if seen.transport.command_lag >= 0 else 0),
    ),
    # One sample more than a command: a state may come after the sample that its command was waited for by. Below 0 the state is
    # ahead of the sample, which waited here or on its way; samples that wait for longer than a lease are stale.
    Rule(
        controller_heard,
        TripCause.CONTROLLER_SILENT,
        lambda seen, _: float(seen.transport.state_lag),
        lambda seen, limits: float(limits.lease_samples + 2 if seen.transport.state_lag >= 0 else -limits.lease_samples),
    ),
    Rule(
        gate_holds,
        TripCause.GATE_CUT,
        lambda seen, _: float(seen.transport.gate),
        lambda _, __: float(_OPEN),
    ),
    Rule(
        controller_ready,
        TripCause.NOT_READY,
        lambda seen, _: 1.0 if seen.transport.ready else 0.0,
        lambda _, __: 1.0,
    ),
)
