"""What the supervisor remembers after each mode: arming ids are drawn on entering, a trip latches its cause."""

from typing import NamedTuple

from hydrohil.services.supervisor.modes import ARMED, DISARMED, HOLD_RECOVER, RECOVER, RUNNING, TRIPPED
from hydrohil.services.supervisor.observe import ObserverMemory, bias_restart
from hydrohil.services.supervisor.recovery import redirects, trips_recovery, unloading_signs
from hydrohil.services.supervisor.rule import Observed
from hydrohil.services.supervisor.state import NO_SIGNS, SupervisorMemory, SupervisorParams
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import NO_COMMAND, TripCause

_ESTOP = int(TripCause.ESTOP)


class Judgement(NamedTuple):
    """What one step has found before the mode changes."""

    number: int  # of the sample
    event: int
    new_arming_id: int
    stopped: bool  # an emergency stop comes with this step, here or at the gate
    pressed: bool  # that one, or an earlier one that no reset has released
    broken: tuple[int, float, float]  # cause, measured value and limit of the first rule that does not hold
    observed: Observed
    observer: ObserverMemory


@kernel
def memory_in(mode: int, before: SupervisorMemory, params: SupervisorParams, judgement: Judgement) -> SupervisorMemory:
    """Memory after a step that ends in `mode`."""
    memory = _carried(mode, before, judgement)
    if mode == DISARMED:
        return _disarmed(memory)
    if mode == ARMED and before.mode != ARMED:
        return _armed(memory, judgement)
    if mode == RUNNING and before.mode != RUNNING:
        return _started(memory, params, judgement)
    if mode == TRIPPED and before.mode != TRIPPED:
        return _tripped(memory, before, params, judgement)
    if mode == RECOVER:
        return _recovering(memory, before, params, judgement)
    return memory


@kernel
def _carried(mode: int, before: SupervisorMemory, judgement: Judgement) -> SupervisorMemory:
    """As before, in `mode`."""
    return SupervisorMemory(
        mode=mode,
        arming_id=before.arming_id,
        cause=before.cause,
        measured=before.measured,
        limit=before.limit,
        trip_number=before.trip_number,
        first_sample=before.first_sample,
        armed_at=before.armed_at,
        held_until=before.held_until,
        recover_signs=before.recover_signs,
        observer=judgement.observer,
        pressed=judgement.pressed,
    )


@kernel
def _disarmed(memory: SupervisorMemory) -> SupervisorMemory:
    """No arming, no trip and no trial."""
    return SupervisorMemory(
        mode=memory.mode,
        arming_id=0,
        cause=0,
        measured=0.0,
        limit=0.0,
        trip_number=NO_COMMAND,
        first_sample=NO_COMMAND,
        armed_at=memory.armed_at,
        held_until=memory.held_until,
        recover_signs=NO_SIGNS,
        observer=memory.observer,
        pressed=memory.pressed,
    )


@kernel
def _armed(memory: SupervisorMemory, judgement: Judgement) -> SupervisorMemory:
    """A new arming id, from this sample on."""
    return SupervisorMemory(
        mode=memory.mode,
        arming_id=judgement.new_arming_id,
        cause=memory.cause,
        measured=memory.measured,
        limit=memory.limit,
        trip_number=memory.trip_number,
        first_sample=memory.first_sample,
        armed_at=judgement.number,
        held_until=memory.held_until,
        recover_signs=memory.recover_signs,
        observer=memory.observer,
        pressed=memory.pressed,
    )


@kernel
def _started(memory: SupervisorMemory, params: SupervisorParams, judgement: Judgement) -> SupervisorMemory:
    """A trial is announced, and the bias is measured again."""
    return SupervisorMemory(
        mode=memory.mode,
        arming_id=memory.arming_id,
        cause=memory.cause,
        measured=memory.measured,
        limit=memory.limit,
        trip_number=memory.trip_number,
        first_sample=judgement.number + params.lead_samples,
        armed_at=memory.armed_at,
        held_until=memory.held_until,
        recover_signs=memory.recover_signs,
        observer=bias_restart(memory.observer),
        pressed=memory.pressed,
    )


@kernel
def _tripped(
    memory: SupervisorMemory, before: SupervisorMemory, params: SupervisorParams, judgement: Judgement
) -> SupervisorMemory:
    """The arming ends. The cause is latched; after a recovery only one that has tripped it."""
    memory = _granted(memory, 0, NO_COMMAND, memory.held_until)
    if before.mode == RECOVER and not trips_recovery(before, params, judgement.observed, judgement.broken[0]):
        return memory
    return _latched(memory, params, judgement, (_ESTOP, 0.0, 0.0) if judgement.stopped else judgement.broken)


@kernel
def _recovering(
    memory: SupervisorMemory, before: SupervisorMemory, params: SupervisorParams, judgement: Judgement
) -> SupervisorMemory:
    """Entered with a new arming id, in the direction of what is broken now; each request extends the hold-to-run lease."""
    held_until = judgement.number + params.recover_samples if judgement.event == HOLD_RECOVER else memory.held_until
    if before.mode == RECOVER:
        return _granted(memory, memory.arming_id, memory.first_sample, held_until)
    memory = _granted(memory, judgement.new_arming_id, memory.first_sample, held_until)
    if redirects(before, params, judgement.observed, judgement.broken[0]):
        return _latched(memory, params, judgement, judgement.broken)
    return memory


@kernel
def _granted(memory: SupervisorMemory, arming_id: int, first_sample: int, held_until: int) -> SupervisorMemory:
    """With another arming id, announced sample and end of the hold-to-run lease."""
    return SupervisorMemory(
        mode=memory.mode,
        arming_id=arming_id,
        cause=memory.cause,
        measured=memory.measured,
        limit=memory.limit,
        trip_number=memory.trip_number,
        first_sample=first_sample,
        armed_at=memory.armed_at,
        held_until=held_until,
        recover_signs=memory.recover_signs,
        observer=memory.observer,
        pressed=memory.pressed,
    )


@kernel
def _latched(
    memory: SupervisorMemory, params: SupervisorParams, judgement: Judgement, broken: tuple[int, float, float]
) -> SupervisorMemory:
    """With this cause, its numbers, and the direction that unloads it."""
    cause, measured, limit = broken
    return SupervisorMemory(
        mode=memory.mode,
        arming_id=memory.arming_id,
        cause=cause,
        measured=measured,
        limit=limit,
        trip_number=judgement.number,
        first_sample=memory.first_sample,
        armed_at=memory.armed_at,
        held_until=memory.held_until,
        recover_signs=unloading_signs(params, judgement.observed, cause),
        observer=memory.observer,
        pressed=memory.pressed,
    )
