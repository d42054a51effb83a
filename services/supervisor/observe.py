"""What the supervisor makes of a sample before it judges: windows and estimates, carried from sample to sample."""

import math
from typing import NamedTuple

from hydrohil.services.supervisor.observe_force import ForceMemory, GaugeMotion, force_step
from hydrohil.services.supervisor.observe_motion import DriveCodes, LinkProgress, MotionMemory, Pose, motion_step
from hydrohil.services.supervisor.rule import Observed, TransportObservation
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.converters import Calibration
from hydrohil.shared.contract.deadline_window import DeadlineWindow, deadline_window_step
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL, Sample
from hydrohil.shared.contract.pose import forward, joint_positions
from hydrohil.shared.contract.timeliness import answered_in_time
from hydrohil.shared.machine.description import Gauge, Geometry


class ObserverParams(NamedTuple):
    """What the windows need to know of the machine and the trial."""

    calibration: Calibration
    geometry: Geometry
    gauge: Gauge
    tip_count_m: float
    codes: DriveCodes
    tare_ticks: int
    period_ns: int
    force_axis: int
    force_sign: float
    quiet_counts: int
    contact_level_n: float


class Bias(NamedTuple):
    """The supervisor's own mean and standard deviation of the force at the negative ticks."""

    mean_n: float
    spread_n: float
    sum_n: float
    square_n2: float
    samples: int


class ObserverMemory(NamedTuple):
    """State of the observer; `observer_start()` before the first sample."""

    last_number: int
    last_tick: int
    last_time_ns: int
    bias: Bias
    answers: DeadlineWindow
    force: ForceMemory
    motion: MotionMemory


class LinkHealth(NamedTuple):
    """What the inboxes of the supervisor have counted."""

    faults: int
    epoch_conflicts: int
    other_run: int
    state_lag: int  # samples since the one that the controller's newest state answers


class SampleContext(NamedTuple):
    """What is judged besides the sample."""

    running: bool  # the mode
    stale_ns: int  # 0 when a sample came; otherwise wall time since the last
    ready: bool  # the controller reports that it is
    links: LinkHealth


@kernel
def observe_step(
    memory: ObserverMemory, params: ObserverParams, sample: Sample, context: SampleContext
) -> tuple[ObserverMemory, Observed]:
    """Take one sample, or its absence, into the windows; returns them and what the rules judge."""
    came, known = context.stale_ns == 0, memory.last_number != NO_COMMAND
    went_back = context.running and came and sample.number <= memory.last_number
    lost = sample.number - memory.last_number - 1 if came and known else 0
    bias = bias_step(memory.bias, params, sample) if came else memory.bias
    follows = known and _follows(memory, sample) if came else known
    dt_ns = _since(memory, params, sample, follows) if came else 0
    pose = _pose(params, sample)
    motion, motion_observation = motion_step(memory.motion, params.codes, pose, sample.dac_counts, follows, dt_ns)
    before_m = memory.motion.tip_m if follows else pose.tip_m
    gauge_motion = GaugeMotion(
        follows=follows,
        way_m=(pose.tip_m[params.force_axis] - before_m[params.force_axis]) * -params.force_sign,
        speed_m_per_s=motion.tip_m_per_s[params.force_axis],
        dt_ns=dt_ns,
        bias_n=bias.mean_n,
        bias_spread_n=bias.spread_n,
    )
    force, gauge_observation = force_step(
        memory.force,
        params.gauge,
        gauge_motion,
        counts=sample.force_counts,
        raw_n=sample.force_counts * params.calibration.force_n_per_count,
        tip_count_m=params.tip_count_m,
        quiet_counts=params.quiet_counts,
        level_n=params.contact_level_n,
    )
    in_trial = context.running and sample.tick != NO_TRIAL
    answers = DeadlineWindow(0, 0, 0, 0)
    if in_trial and sample.tick > 0:  # the first sample that reports how that of tick 0 was answered
        answers = deadline_window_step(memory.answers, lost, answered_in_time(sample)) if came else memory.answers
    observed = Observed(
        moving=(in_trial and sample.tick >= 0) or went_back,
        starting=in_trial and sample.tick >= -1,
        tick=sample.tick,
        gauge=gauge_observation,
        motion=motion_observation,
        transport=_transport(sample, context, lost, answers.missed),
    )
    if not came:  # the sample before is judged once more; it is not taken in twice
        return memory, observed
    after = ObserverMemory(
        last_number=sample.number,
        last_tick=sample.tick,
        last_time_ns=sample.time_ns,
        bias=bias,
        answers=answers,
        force=force,
        motion=motion,
    )
    return after, observed


@kernel
def _pose(params: ObserverParams, sample: Sample) -> Pose:
    """Where the encoders of a sample say that the arm is."""
    q, pitch_rad = joint_positions(params.calibration, sample.encoder_counts)
    return Pose(
        counts=(sample.encoder_counts[0], sample.encoder_counts[1], sample.encoder_counts[2]),
        q=q,
        pitch_rad=pitch_rad,
        tip_m=forward(params.geometry, q, pitch_rad),
    )


@kernel
def _transport(sample: Sample, context: SampleContext, lost: int, missed: int) -> TransportObservation:
    return TransportObservation(
        lost_samples=lost,
        stale_ns=context.stale_ns,
        command_lag=sample.number - sample.command_number,
        gate=sample.gate,
        ready=context.ready,
        link_faults=context.links.faults,
        epoch_conflicts=context.links.epoch_conflicts,
        other_run=context.links.other_run if context.running else 0,
        state_lag=context.links.state_lag,
        missed=missed,
    )


@kernel
def _follows(memory: ObserverMemory, sample: Sample) -> bool:
    """Whether the sample before is older and of the same trial: at a trial's first tick an emulator begins at another pose."""
    same_trial = (sample.tick == NO_TRIAL) == (memory.last_tick == NO_TRIAL) and sample.tick >= memory.last_tick
    return sample.number > memory.last_number and same_trial


@kernel
def _since(memory: ObserverMemory, params: ObserverParams, sample: Sample, follows: bool) -> int:
    """Time since the sample before; at most twice what its number says, so that no stamp can widen a limit."""
    if not follows:
        return params.period_ns
    by_number_ns = (sample.number - memory.last_number) * params.period_ns
    by_stamp_ns = sample.time_ns - memory.last_time_ns
    return by_stamp_ns if 0 < by_stamp_ns <= 2 * by_number_ns else by_number_ns


@kernel
def bias_step(bias: Bias, params: ObserverParams, sample: Sample) -> Bias:
    """Mean and standard deviation of the force at the negative ticks (thesis 5.1.2)."""
    if not -params.tare_ticks <= sample.tick < 0:
        return bias
    force_n = sample.force_counts * params.calibration.force_n_per_count
    total, square, count = force_n, force_n * force_n, 1
    if sample.tick > -params.tare_ticks:
        total, square, count = bias.sum_n + total, bias.square_n2 + square, bias.samples + 1
    mean = total / count
    spread_n = math.sqrt(max(0.0, square / count - mean * mean))
    return Bias(mean_n=mean, spread_n=spread_n, sum_n=total, square_n2=square, samples=count)


@kernel
def bias_restart(memory: ObserverMemory) -> ObserverMemory:
    """A trial begins: the sums of the one before leave no trace, even if its first sample is lost."""
    return ObserverMemory(
        last_number=memory.last_number,
        last_tick=memory.last_tick,
        last_time_ns=memory.last_time_ns,
        bias=Bias(mean_n=memory.bias.mean_n, spread_n=memory.bias.spread_n, sum_n=0.0, square_n2=0.0, samples=0),
        answers=DeadlineWindow(0, 0, 0, 0),
        force=memory.force,
        motion=memory.motion,
    )


@kernel
def observer_start() -> ObserverMemory:
    """No sample has come; the windows begin at the first. No defaults: compiled callers know none that are tuples."""
    still, link = (0.0, 0.0, 0.0), LinkProgress(sign=0, furthest_q=0.0, idle_ns=0)
    return ObserverMemory(
        last_number=NO_COMMAND,
        last_tick=NO_TRIAL,
        last_time_ns=0,
        bias=Bias(mean_n=0.0, spread_n=0.0, sum_n=0.0, square_n2=0.0, samples=0),
        answers=DeadlineWindow(0, 0, 0, 0),
        force=ForceMemory(counts=0, raw_n=0.0, smooth_n=0.0, explained_n=0.0, quiet_samples=0, held_ns=0, energy_j=0.0),
        motion=MotionMemory(
            q=still,
            pitch_rad=0.0,
            tip_m=still,
            speed=still,
            tip_m_per_s=still,
            rotate=link,
            down_up=link,
            out_in=link,
        ),
    )
