"""One step of the supervisor: observe, judge, change mode, issue the permit. Verdict n is a function of sample n."""

import math
from typing import NamedTuple

from services.supervisor.modes import (
    ARMED,
    DISARMED,
    HOLD_RECOVER,
    RECOVER,
    RUNNING,
    TRIPPED,
    Facts,
    next_mode,
)
from services.supervisor.modes import ESTOP as ESTOP_EVENT
from services.supervisor.rules import Limits, Observed, first_broken
from shared.converters import Calibration
from shared.kernel import kernel
from shared.messages import NO_COMMAND, NO_TRIAL, GateCause, Permit, Sample, TripCause
from shared.pose import UNIMATE_GEOMETRY, forward, joint_positions

_ESTOP, _FORCE_INVALID, _FORCE_RAW, _FORCE_TARED = (
    int(TripCause.ESTOP),
    int(TripCause.FORCE_INVALID),
    int(TripCause.FORCE_RAW),
    int(TripCause.FORCE_TARED),
)
_JOINT_LIMIT = int(TripCause.JOINT_LIMIT)
_GATE_STOPPED = int(GateCause.ESTOP)
_NO_SIGNS = (0, 0, 0)


class SupervisorParams(NamedTuple):
    """Everything the supervisor is told before a trial."""

    limits: Limits
    calibration: Calibration
    force_axis: int
    force_sign: float
    duration_ticks: int
    bias_ticks: int
    lead_samples: int  # from START to the trial's first sample, so that everyone knows it in advance
    armed_samples: int  # ARMED unused for longer is disarmed
    recover_samples: int  # lease of a hold-to-run request


class Asked(NamedTuple):
    """What has come besides the sample."""

    event: int
    new_arming: int  # a number drawn for this step, used if it arms
    agreed: bool  # all services report this experiment, run and version, and the gate's limit stands above
    controller_ready: bool
    stale_ns: int  # 0 when a sample came; otherwise wall time since the last


class SupervisorMemory(NamedTuple):
    """State of the supervisor."""

    mode: int = DISARMED
    arming: int = 0
    cause: int = 0
    measured: float = 0.0  # what tripped
    limit: float = 0.0
    trip_number: int = NO_COMMAND
    first_sample: int = NO_COMMAND
    armed_at: int = 0
    held_until: int = 0
    last_number: int = NO_COMMAND
    bias_n: float = 0.0
    bias_spread_n: float = 0.0
    bias_sum_n: float = 0.0
    bias_square_n2: float = 0.0
    bias_count: int = 0
    recover_signs: tuple[int, int, int] = _NO_SIGNS


@kernel
def supervisor_step(
    memory: SupervisorMemory, params: SupervisorParams, sample: Sample, asked: Asked
) -> tuple[SupervisorMemory, Permit]:
    """Judge one sample (or its absence, when asked.stale_ns > 0) and say who may move."""
    if asked.stale_ns == 0:
        memory = _take_bias(memory, params, sample)
    seen = observe(memory, params, sample, asked)
    broken, measured, limit = first_broken(seen, params.limits)
    facts = Facts(
        broken,
        sample.gate_cause == _GATE_STOPPED,  # pressed at the gate: either alone suffices
        asked.agreed,
        _can_recover(memory) and not (memory.mode == RECOVER and _force_on_top(memory, broken)),
        sample.number < memory.held_until or asked.event == HOLD_RECOVER,
        memory.mode == RUNNING and sample.number >= memory.first_sample + params.bias_ticks + params.duration_ticks,
        memory.mode == ARMED and sample.number - memory.armed_at > params.armed_samples,
    )
    mode = next_mode(memory.mode, asked.event, facts)
    memory = _enter(memory, params, sample, asked, seen, (broken, measured, limit), mode)
    return memory, _permit(memory, params)


@kernel
def observe(memory: SupervisorMemory, params: SupervisorParams, sample: Sample, asked: Asked) -> Observed:
    """What the rules judge."""
    q_rad, pitch_rad = joint_positions(params.calibration, sample.encoder_counts)
    raw_n = sample.force_counts * params.calibration.force_n_per_count
    running = memory.mode == RUNNING and sample.tick != NO_TRIAL
    went_back = memory.mode == RUNNING and asked.stale_ns == 0 and sample.number <= memory.last_number
    lost = 0
    if memory.last_number != NO_COMMAND and asked.stale_ns == 0:
        lost = sample.number - memory.last_number - 1
    return Observed(
        (running and sample.tick >= 0) or went_back,
        running and sample.tick >= -1,
        sample.force_counts,
        raw_n,
        raw_n - memory.bias_n,
        memory.bias_n,
        memory.bias_spread_n,
        q_rad,
        forward(UNIMATE_GEOMETRY, q_rad, pitch_rad),
        lost,
        asked.stale_ns,
        sample.number - sample.command_number,
        sample.gate,
        sample.tick,
        asked.controller_ready,
    )


@kernel
def _take_bias(memory: SupervisorMemory, params: SupervisorParams, sample: Sample) -> SupervisorMemory:
    """The supervisor's own mean and spread of the force at the negative ticks (thesis 5.1.2)."""
    if not -params.bias_ticks <= sample.tick < 0:
        return memory
    force_n = sample.force_counts * params.calibration.force_n_per_count
    total, square, count = force_n, force_n * force_n, 1
    if sample.tick > -params.bias_ticks:
        total, square, count = memory.bias_sum_n + total, memory.bias_square_n2 + square, memory.bias_count + 1
    mean = total / count
    variance = square / count - mean * mean
    spread = math.sqrt(variance) if variance > 0.0 else 0.0
    return _with_bias(memory, mean, spread, total, square, count)


@kernel
def _with_bias(
    memory: SupervisorMemory, bias_n: float, spread_n: float, total: float, square: float, count: int
) -> SupervisorMemory:
    return SupervisorMemory(
        memory.mode,
        memory.arming,
        memory.cause,
        memory.measured,
        memory.limit,
        memory.trip_number,
        memory.first_sample,
        memory.armed_at,
        memory.held_until,
        memory.last_number,
        bias_n,
        spread_n,
        total,
        square,
        count,
        memory.recover_signs,
    )


@kernel
def _can_recover(memory: SupervisorMemory) -> bool:
    signs = memory.recover_signs
    return signs[0] != 0 or signs[1] != 0 or signs[2] != 0


@kernel
def _force_on_top(memory: SupervisorMemory, broken: int) -> bool:
    """Recovering from a joint limit has met a force: another cause, with another direction."""
    return memory.cause == _JOINT_LIMIT and 0 < broken < _JOINT_LIMIT


@kernel
def _enter(
    memory: SupervisorMemory,
    params: SupervisorParams,
    sample: Sample,
    asked: Asked,
    seen: Observed,
    broken: tuple[int, float, float],
    mode: int,
) -> SupervisorMemory:
    """Memory after the change of mode: arming numbers are drawn on entering, a trip latches its cause."""
    arming, cause, trip_number = memory.arming, memory.cause, memory.trip_number
    measured, limit = memory.measured, memory.limit
    first_sample, armed_at, held_until = memory.first_sample, memory.armed_at, memory.held_until
    signs = memory.recover_signs
    if mode == DISARMED:
        arming, cause, trip_number, first_sample, signs = 0, 0, NO_COMMAND, NO_COMMAND, _NO_SIGNS
        measured, limit = 0.0, 0.0
    if mode == ARMED and memory.mode != ARMED:
        arming, armed_at = asked.new_arming, sample.number
    if mode == RUNNING and memory.mode != RUNNING:
        first_sample = sample.number + params.lead_samples
        memory = _with_bias(memory, memory.bias_n, memory.bias_spread_n, 0.0, 0.0, 0)
    if mode == TRIPPED and memory.mode != TRIPPED:
        arming, first_sample = 0, NO_COMMAND
        if memory.mode != RECOVER or _force_on_top(memory, broken[0]):
            cause, measured, limit = broken
            if sample.gate_cause == _GATE_STOPPED or asked.event == ESTOP_EVENT:
                cause, measured, limit = _ESTOP, 0.0, 0.0
            trip_number, signs = sample.number, _unloading(params, seen, cause)
    if mode == RECOVER:
        if memory.mode != RECOVER:
            arming = asked.new_arming
        if asked.event == HOLD_RECOVER:
            held_until = sample.number + params.recover_samples
    return SupervisorMemory(
        mode,
        arming,
        cause,
        measured,
        limit,
        trip_number,
        first_sample,
        armed_at,
        held_until,
        sample.number,
        memory.bias_n,
        memory.bias_spread_n,
        memory.bias_sum_n,
        memory.bias_square_n2,
        memory.bias_count,
        signs,
    )


@kernel
def _unloading(params: SupervisorParams, seen: Observed, cause: int) -> tuple[int, int, int]:
    """Sign per link that lowers the violated quantity; zeros where there is none.

    A force along z is unloaded by link 2 (positive down), one along x by link 3 (positive out).
    """
    if cause in (_FORCE_INVALID, _FORCE_RAW, _FORCE_TARED, _ESTOP):
        away = 1 if params.force_sign > 0.0 else -1
        return (0, -away, 0) if params.force_axis == 2 else (0, 0, away)
    if cause == _JOINT_LIMIT:
        config = params.limits.config
        return (
            _inward(seen.q_rad[0], config.joint_low_rad[0], config.joint_high_rad[0]),
            _inward(seen.q_rad[1], config.joint_low_rad[1], config.joint_high_rad[1]),
            _inward(seen.q_rad[2], config.joint_low_rad[2], config.joint_high_rad[2]),
        )
    return (0, 0, 0)


@kernel
def _inward(q_rad: float, low_rad: float, high_rad: float) -> int:
    if q_rad < low_rad:
        return 1
    return -1 if q_rad > high_rad else 0


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
        params.bias_ticks,
        signs,
        params.limits.config.force_limit_n,
        memory.bias_n,
    )
