"""One step of the supervisor: observe, judge, change mode, issue the permit. Verdict n is a function of sample n."""

import math
from typing import NamedTuple

from hydrohil.services.supervisor.modes import ARMED, DISARMED, HOLD_RECOVER, RECOVER, RESET, RUNNING, TRIPPED, Facts, next_mode
from hydrohil.services.supervisor.modes import ESTOP as ESTOP_EVENT
from hydrohil.services.supervisor.observe import Heard, Links, Observing, Watch, bias_anew, observe_step, watch_start
from hydrohil.services.supervisor.rule import Limits, Observed
from hydrohil.services.supervisor.rules import first_broken
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import NO_COMMAND, GateCause, Permit, Sample, TripCause

_ESTOP, _LAST_OF_FORCE, _JOINT_LIMIT = int(TripCause.ESTOP), int(TripCause.FORCE_BELOW_BIAS), int(TripCause.JOINT_LIMIT)
_GATE_STOPPED = int(GateCause.ESTOP)
_NO_SIGNS = (0, 0, 0)


class SupervisorParams(NamedTuple):
    """Everything the supervisor is told before a trial."""

    limits: Limits
    observing: Observing
    duration_ticks: int
    lead_samples: int  # from START to the trial's first sample, so that everyone knows it in advance
    armed_samples: int  # ARMED unused for longer is disarmed
    recover_samples: int  # lease of a hold-to-run request


class Asked(NamedTuple):
    """What has come besides the sample."""

    event: int
    new_arming_id: int  # a number drawn for this step, used if it arms
    agreed: bool  # all services report this experiment, run and version, and the gate's limit stands above
    controller_ready: bool
    stale_ns: int  # 0 when a sample came; otherwise wall time since the last
    links: Links


class SupervisorMemory(NamedTuple):
    """State of the supervisor."""

    mode: int = DISARMED
    arming_id: int = 0
    cause: int = 0
    measured: float = 0.0  # what tripped
    limit: float = 0.0
    trip_number: int = NO_COMMAND
    first_sample: int = NO_COMMAND
    armed_at: int = 0
    held_until: int = 0
    recover_signs: tuple[int, int, int] = _NO_SIGNS
    watch: Watch = watch_start()
    pressed: bool = False  # an emergency stop, here or at the gate, that no reset has released


@kernel
def supervisor_step(
    memory: SupervisorMemory, params: SupervisorParams, sample: Sample, asked: Asked
) -> tuple[SupervisorMemory, Permit]:
    """Judge one sample (or its absence, when asked.stale_ns > 0) and say who may move."""
    heard = Heard(memory.mode == RUNNING, asked.stale_ns, asked.controller_ready, asked.links)
    watch, seen = observe_step(memory.watch, params.observing, sample, heard)
    broken, measured, limit = first_broken(seen, params.limits)
    facts = Facts(
        broken,
        sample.gate_cause == _GATE_STOPPED,  # pressed at the gate: either alone suffices
        asked.agreed,
        _can_recover(memory, params, seen, broken),
        sample.number < memory.held_until or asked.event == HOLD_RECOVER,
        memory.mode == RUNNING and sample.number >= memory.first_sample + params.observing.tare_ticks + params.duration_ticks,
        memory.mode == ARMED and sample.number - memory.armed_at > params.armed_samples,
    )
    mode = next_mode(memory.mode, asked.event, facts)
    memory = _enter(memory, params, sample, asked, seen, (broken, measured, limit), mode, watch)
    return memory, _permit(memory, params)


@kernel
def _can_recover(memory: SupervisorMemory, params: SupervisorParams, seen: Observed, broken: int) -> bool:
    if memory.pressed:
        return False
    if memory.mode == RECOVER:
        return not _on_top(memory, params, seen, broken)
    return _leads(memory.recover_signs) or _leads(_unloading(params, seen, broken))


@kernel
def _leads(signs: tuple[int, int, int]) -> bool:
    return signs[0] != 0 or signs[1] != 0 or signs[2] != 0


@kernel
def _elsewhere(memory: SupervisorMemory, params: SupervisorParams, seen: Observed, broken: int) -> bool:
    """What stands now leads another way than the latched cause: a joint limit outlasts the force, or was met under it."""
    now = _unloading(params, seen, broken)
    return _leads(now) and now != memory.recover_signs


@kernel
def _on_top(memory: SupervisorMemory, params: SupervisorParams, seen: Observed, broken: int) -> bool:
    """Recovering has met another cause, more severe or of another direction: it trips anew. All of force are one."""
    if broken == 0 or broken == memory.cause:
        return False
    return _elsewhere(memory, params, seen, broken) or memory.cause > max(broken, _LAST_OF_FORCE)


@kernel
def _enter(
    memory: SupervisorMemory,
    params: SupervisorParams,
    sample: Sample,
    asked: Asked,
    seen: Observed,
    broken: tuple[int, float, float],
    mode: int,
    watch: Watch,
) -> SupervisorMemory:
    """Memory after the change of mode: arming ids are drawn on entering, a trip latches its cause."""
    arming_id, cause, trip_number = memory.arming_id, memory.cause, memory.trip_number
    measured, limit = memory.measured, memory.limit
    first_sample, armed_at, held_until = memory.first_sample, memory.armed_at, memory.held_until
    signs = memory.recover_signs
    stopped = sample.gate_cause == _GATE_STOPPED or asked.event == ESTOP_EVENT
    if mode == DISARMED:
        arming_id, cause, trip_number, first_sample, signs = 0, 0, NO_COMMAND, NO_COMMAND, _NO_SIGNS
        measured, limit = 0.0, 0.0
    if mode == ARMED and memory.mode != ARMED:
        arming_id, armed_at = asked.new_arming_id, sample.number
    if mode == RUNNING and memory.mode != RUNNING:
        first_sample = sample.number + params.lead_samples
        watch = bias_anew(watch)
    if mode == TRIPPED and memory.mode != TRIPPED:
        arming_id, first_sample = 0, NO_COMMAND
        if memory.mode != RECOVER or _on_top(memory, params, seen, broken[0]):
            cause, measured, limit = broken
            if stopped:
                cause, measured, limit = _ESTOP, 0.0, 0.0
            trip_number, signs = sample.number, _unloading(params, seen, cause)
    if mode == RECOVER:
        if memory.mode != RECOVER:
            arming_id = asked.new_arming_id
            if _elsewhere(memory, params, seen, broken[0]):
                cause, measured, limit = broken
                trip_number, signs = sample.number, _unloading(params, seen, cause)
        if asked.event == HOLD_RECOVER:
            held_until = sample.number + params.recover_samples
    pressed = stopped or (memory.pressed and asked.event != RESET)
    return SupervisorMemory(
        mode,
        arming_id,
        cause,
        measured,
        limit,
        trip_number,
        first_sample,
        armed_at,
        held_until,
        signs,
        watch,
        pressed,
    )


@kernel
def _unloading(params: SupervisorParams, seen: Observed, cause: int) -> tuple[int, int, int]:
    """Sign per link that lowers the violated quantity; zeros where there is none.

    A gauge that is not believed has one too: away from the environment is geometry, and the operator holds it by hand.
    A force along z is unloaded by link 2 (positive down), one along x by link 3 (positive out).
    """
    if _ESTOP <= cause <= _LAST_OF_FORCE:
        away = int(math.copysign(1.0, params.observing.force_sign))
        return (0, -away, 0) if params.observing.force_axis == 2 else (0, 0, away)
    if cause == _JOINT_LIMIT:
        config = params.limits.config
        return (
            _inward(seen.motion.q[0], config.joint_low_q[0], config.joint_high_q[0]),
            _inward(seen.motion.q[1], config.joint_low_q[1], config.joint_high_q[1]),
            _inward(seen.motion.q[2], config.joint_low_q[2], config.joint_high_q[2]),
        )
    return (0, 0, 0)


@kernel
def _inward(q: float, low_q: float, high_q: float) -> int:
    if q < low_q:
        return 1
    return -1 if q > high_q else 0


@kernel
def _permit(memory: SupervisorMemory, params: SupervisorParams) -> Permit:
    signs = memory.recover_signs if memory.mode == RECOVER else _NO_SIGNS
    return Permit(
        memory.mode,
        memory.cause,
        memory.measured,
        memory.limit,
        memory.trip_number,
        memory.first_sample,
        params.duration_ticks,
        params.observing.tare_ticks,
        signs,
        params.limits.config.force_limit_n,
        memory.watch.bias.mean_n,
    )
