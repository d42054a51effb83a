"""What the supervisor makes of a sample before it judges: windows and estimates, carried from sample to sample."""

import math
from typing import NamedTuple

from services.supervisor.answers import Answers, answers_step
from services.supervisor.rule import GaugeSeen, MotionSeen, Observed, TransportSeen
from shared.converters import Calibration
from shared.kernel import kernel
from shared.messages import NO_COMMAND, NO_TRIAL, Sample
from shared.pose import UNIMATE_GEOMETRY, forward, joint_positions


class Observing(NamedTuple):
    """What observing needs to know of the machine and the trial."""

    calibration: Calibration
    bias_ticks: int


class Bias(NamedTuple):
    """The supervisor's own mean and spread of the force at the negative ticks."""

    mean_n: float = 0.0
    spread_n: float = 0.0
    sum_n: float = 0.0
    square_n2: float = 0.0
    samples: int = 0


class Watch(NamedTuple):
    """What is remembered of the samples."""

    last_number: int = NO_COMMAND
    bias: Bias = Bias()
    answers: Answers = Answers()


class Links(NamedTuple):
    """What the inboxes have shown."""

    faults: int
    rivals: int
    other_run: int


class Heard(NamedTuple):
    """What besides the sample is judged."""

    running: bool  # the mode
    stale_ns: int  # 0 when a sample came; otherwise wall time since the last
    ready: bool  # the controller says so
    links: Links


@kernel
def observe_step(watch: Watch, observing: Observing, sample: Sample, heard: Heard) -> tuple[Watch, Observed]:
    """One sample, or its absence, taken into the windows; and what the rules judge."""
    came = heard.stale_ns == 0
    went_back = heard.running and came and sample.number <= watch.last_number
    lost = sample.number - watch.last_number - 1 if came and watch.last_number != NO_COMMAND else 0
    bias = bias_step(watch.bias, observing, sample) if came else watch.bias
    q_rad, pitch_rad = joint_positions(observing.calibration, sample.encoder_counts)
    raw_n = sample.force_counts * observing.calibration.force_n_per_count
    in_trial = heard.running and sample.tick != NO_TRIAL
    answers = Answers(0, 0, 0, 0)
    if in_trial and sample.tick > 0:  # from the sample on that tells how that of tick 0 was answered
        answers = answers_step(watch.answers, lost, answered_in_time(sample)) if came else watch.answers
    seen = Observed(
        (in_trial and sample.tick >= 0) or went_back,
        in_trial and sample.tick >= -1,
        sample.tick,
        GaugeSeen(sample.force_counts, raw_n, raw_n - bias.mean_n, bias.mean_n, bias.spread_n),
        MotionSeen(q_rad, forward(UNIMATE_GEOMETRY, q_rad, pitch_rad)),
        TransportSeen(
            lost,
            heard.stale_ns,
            sample.number - sample.command_number,
            sample.gate,
            heard.ready,
            heard.links.faults,
            heard.links.rivals,
            heard.links.other_run if heard.running else 0,
            answers.missed,
        ),
    )
    return Watch(sample.number, bias, answers), seen


@kernel
def answered_in_time(sample: Sample) -> bool:
    """Whether the command that answers the sample before this one was in force at its latch."""
    return sample.command_number == sample.number - 1 and sample.command_late_substeps == 0


@kernel
def bias_step(bias: Bias, observing: Observing, sample: Sample) -> Bias:
    """Mean and standard deviation of the force at the negative ticks (thesis 5.1.2)."""
    if not -observing.bias_ticks <= sample.tick < 0:
        return bias
    force_n = sample.force_counts * observing.calibration.force_n_per_count
    total, square, count = force_n, force_n * force_n, 1
    if sample.tick > -observing.bias_ticks:
        total, square, count = bias.sum_n + total, bias.square_n2 + square, bias.samples + 1
    mean = total / count
    variance = square / count - mean * mean
    return Bias(mean, math.sqrt(variance) if variance > 0.0 else 0.0, total, square, count)


@kernel
def bias_anew(watch: Watch) -> Watch:
    """A trial begins: the sums of the one before leave no trace, even if its first sample is lost."""
    return Watch(watch.last_number, Bias(watch.bias.mean_n, watch.bias.spread_n, 0.0, 0.0, 0), Answers(0, 0, 0, 0))
