"""What must hold of the messages and of the services that send them."""

from hydrohil.services.supervisor.rule import Limits, Observed, Rule
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import GateState, TripCause

_OPEN, _REVOKED = int(GateState.OPEN), int(GateState.REVOKED)


@kernel
def samples_complete(observed: Observed, limits: Limits) -> bool:
    return not observed.moving or 0 <= observed.transport.lost_samples <= limits.lease_samples


@kernel
def samples_fresh(observed: Observed, limits: Limits) -> bool:
    return observed.transport.stale_ns <= limits.lease_ns


@kernel
def commands_fresh(observed: Observed, limits: Limits) -> bool:
    return not (observed.moving and observed.tick > 0) or 0 <= observed.transport.command_lag <= limits.lease_samples + 1


@kernel
def controller_alive(observed: Observed, limits: Limits) -> bool:
    return (
        not (observed.moving and observed.tick > 0)
        or -limits.lease_samples <= observed.transport.state_lag <= limits.lease_samples + 2
    )


@kernel
def gate_holds(observed: Observed, limits: Limits) -> bool:
    return not observed.moving or observed.transport.gate != _REVOKED


@kernel
def controller_ready(observed: Observed, limits: Limits) -> bool:
    return not observed.starting or observed.transport.ready


TRANSPORT_RULES = (
    Rule(
        holds=samples_complete,
        cause=TripCause.SAMPLE_LOST,
        measured=lambda observed, _: float(observed.transport.lost_samples),
        limit=lambda observed, limits: float(limits.lease_samples if observed.transport.lost_samples >= 0 else 0),
    ),
    Rule(
        holds=samples_fresh,
        cause=TripCause.SAMPLE_STALE,
        measured=lambda observed, _: observed.transport.stale_ns * 1e-9,
        limit=lambda _, limits: limits.lease_ns * 1e-9,
    ),
    Rule(
        holds=commands_fresh,
        cause=TripCause.COMMAND_STALE,
        measured=lambda observed, _: float(observed.transport.command_lag),
        limit=lambda observed, limits: float(limits.lease_samples + 1 if observed.transport.command_lag >= 0 else 0),
    ),
    # One sample more than a command: a state may come after the sample that its command was waited for by. Below 0 the state is
    # ahead of the sample, which waited here or on its way; samples that wait for longer than a lease are stale.
    Rule(
        holds=controller_alive,
        cause=TripCause.CONTROLLER_SILENT,
        measured=lambda observed, _: float(observed.transport.state_lag),
        limit=lambda observed, limits: float(
            limits.lease_samples + 2 if observed.transport.state_lag >= 0 else -limits.lease_samples
        ),
    ),
    Rule(
        holds=gate_holds,
        cause=TripCause.GATE_CUT,
        measured=lambda observed, _: float(observed.transport.gate),
        limit=lambda _, __: float(_OPEN),
    ),
    Rule(
        holds=controller_ready,
        cause=TripCause.NOT_READY,
        measured=lambda observed, _: 1.0 if observed.transport.ready else 0.0,
        limit=lambda _, __: 1.0,
    ),
)
