"""What the supervisor makes of a sample before it judges: windows and estimates, carried from sample to sample."""

import math
from typing import NamedTuple

from hydrohil.services.supervisor.observe_force import ForceWatch, Push, force_step
from hydrohil.services.supervisor.observe_motion import Codes, LinkWatch, MotionWatch, Pose, motion_step
from hydrohil.services.supervisor.rule import Observed, TransportObservation
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.converters import Calibration
from hydrohil.shared.contract.deadline_window import DeadlineWindow, deadline_window_step
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL, Sample
from hydrohil.shared.contract.pose import UNIMATE_GEOMETRY, forward, joint_positions
from hydrohil.shared.contract.timeliness import answered_in_time


class Observing(NamedTuple):
    """What observing needs to know of the machine and the trial."""

    calibration: Calibration
    codes: Codes
    tare_ticks: int
    period_ns: int
    force_axis: int
    force_sign: float
    quiet_counts: int
    contact_level_n: float


class Bias(NamedTuple):
    """The supervisor's own mean and spread of the force at the negative ticks."""

    mean_n: float
    spread_n: float
    sum_n: float
    square_n2: float
    samples: int


class Watch(NamedTuple):
    """What is remembered of the samples; `watch_start()` before the first."""

    last_number: int
    last_tick: int
    last_time_ns: int
    bias: Bias
    answers: DeadlineWindow
    force: ForceWatch
    motion: MotionWatch


class Links(NamedTuple):
    """What the inboxes have shown."""

    faults: int
    epoch_conflicts: int
    other_run: int
    state_lag: int  # samples since the one that the controller's newest state answers


class Heard(NamedTuple):
    """What besides the sample is judged."""

    running: bool  # the mode
    stale_ns: int  # 0 when a sample came; otherwise wall time since the last
    ready: bool  # the controller says so
    links: Links


@kernel
def observe_step(watch: Watch, observing: Observing, sample: Sample, heard: Heard) -> tuple[Watch, Observed]:
    """One sample, or its absence, taken into the windows; and what the rules judge."""
    came, known = heard.stale_ns == 0, watch.last_number != NO_COMMAND
    went_back = heard.running and came and sample.number <= watch.last_number
    lost = sample.number - watch.last_number - 1 if came and known else 0
    bias = bias_step(watch.bias, observing, sample) if came else watch.bias
    follows = known and _follows(watch, sample) if came else known
    dt_ns = _since(watch, observing, sample, follows) if came else 0
    q, pitch_rad = joint_positions(observing.calibration, sample.encoder_counts)
    tip_m = forward(UNIMATE_GEOMETRY, q, pitch_rad)
    counts = (sample.encoder_counts[0], sample.encoder_counts[1], sample.encoder_counts[2])
    pose = Pose(counts, q, pitch_rad, tip_m)
    motion, observe_motion = motion_step(watch.motion, observing.codes, pose, sample.dac_counts, follows, dt_ns)
    before_m = watch.motion.tip_m if follows else tip_m
    way_m = (tip_m[observing.force_axis] - before_m[observing.force_axis]) * -observing.force_sign
    speed = motion.tip_m_per_s[observing.force_axis]
    push = Push(follows, way_m, speed, dt_ns, bias.mean_n, bias.spread_n)
    raw_n = sample.force_counts * observing.calibration.force_n_per_count
    force, observe_gauge = force_step(
        watch.force, push, sample.force_counts, raw_n, observing.quiet_counts, observing.contact_level_n
    )
    in_trial = heard.running and sample.tick != NO_TRIAL
    answers = DeadlineWindow(0, 0, 0, 0)
    if in_trial and sample.tick > 0:  # from the sample on that tells how that of tick 0 was answered
        answers = deadline_window_step(watch.answers, lost, answered_in_time(sample)) if came else watch.answers
    seen = Observed(
        (in_trial and sample.tick >= 0) or went_back,
        in_trial and sample.tick >= -1,
        sample.tick,
        observe_gauge,
        observe_motion,
        TransportObservation(
            lost,
            heard.stale_ns,
            sample.number - sample.command_number,
            sample.gate,
            heard.ready,
            heard.links.faults,
            heard.links.epoch_conflicts,
            heard.links.other_run if heard.running else 0,
            heard.links.state_lag,
            answers.missed,
        ),
    )
    if not came:  # the sample before is judged once more; it is not taken in twice
        return watch, seen
    return Watch(sample.number, sample.tick, sample.time_ns, bias, answers, force, motion), seen


@kernel
def _follows(watch: Watch, sample: Sample) -> bool:
    """Whether the sample before is older and of the same trial: at a trial's first tick an emulator begins at another pose."""
    same_trial = (sample.tick == NO_TRIAL) == (watch.last_tick == NO_TRIAL) and sample.tick >= watch.last_tick
    return sample.number > watch.last_number and same_trial


@kernel
def _since(watch: Watch, observing: Observing, sample: Sample, follows: bool) -> int:
    """Time since the sample before; at most twice what its number says, so that no stamp can widen a limit."""
    if not follows:
        return observing.period_ns
    by_number_ns = (sample.number - watch.last_number) * observing.period_ns
    by_stamp_ns = sample.time_ns - watch.last_time_ns
    return by_stamp_ns if 0 < by_stamp_ns <= 2 * by_number_ns else by_number_ns


@kernel
def bias_step(bias: Bias, observing: Observing, sample: Sample) -> Bias:
    """Mean and standard deviation of the force at the negative ticks (thesis 5.1.2)."""
    if not -observing.tare_ticks <= sample.tick < 0:
        return bias
    force_n = sample.force_counts * observing.calibration.force_n_per_count
    total, square, count = force_n, force_n * force_n, 1
    if sample.tick > -observing.tare_ticks:
        total, square, count = bias.sum_n + total, bias.square_n2 + square, bias.samples + 1
    mean = total / count
    return Bias(mean, math.sqrt(max(0.0, square / count - mean * mean)), total, square, count)


@kernel
def bias_anew(watch: Watch) -> Watch:
    """A trial begins: the sums of the one before leave no trace, even if its first sample is lost."""
    bias = Bias(watch.bias.mean_n, watch.bias.spread_n, 0.0, 0.0, 0)
    return Watch(
        watch.last_number, watch.last_tick, watch.last_time_ns, bias, DeadlineWindow(0, 0, 0, 0), watch.force, watch.motion
    )


@kernel
def watch_start() -> Watch:
    """Nothing seen yet; its windows begin at the first sample. No defaults: compiled callers know none that are tuples."""
    still, link = (0.0, 0.0, 0.0), LinkWatch(0, 0.0, 0)
    motion = MotionWatch(still, 0.0, still, still, still, link, link, link)
    force = ForceWatch(0, 0.0, 0.0, 0.0, 0, 0, 0.0)
    return Watch(NO_COMMAND, NO_TRIAL, 0, Bias(0.0, 0.0, 0.0, 0.0, 0), DeadlineWindow(0, 0, 0, 0), force, motion)
