"""Where in a trial a sample stands: its start pose, the force bias of its negative ticks, and whether the law may run."""

from typing import NamedTuple

from hydrohil.services.controller.regression import POINTS
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import NO_TRIAL, GateState, Sample
from hydrohil.shared.machine.description import Triple

GATE_SHUT, GATE_OPEN = int(GateState.SHUT), int(GateState.OPEN)


class Trial(NamedTuple):
    """What the controller knows of the trial that it is in."""

    number: int  # of the last sample
    tick: int  # of the last sample
    time_ns: int  # of the last sample
    started: bool  # its first tick has come: start pose and bias belong to this trial
    whole: bool  # and no sample was lost before tick 0
    samples: int  # since the buffers were filled
    q_start: Triple
    x_start_m: Triple
    bias_sum_counts: int
    bias_samples: int


@kernel
def begun_trial(number: int, tick: int, time_ns: int, first: bool, q: Triple, x: Triple) -> Trial:
    """The trial of which nothing has been counted yet; `first`: the sample is its first."""
    return Trial(
        number=number,
        tick=tick,
        time_ns=time_ns,
        started=first,
        whole=first,
        samples=0,
        q_start=q,
        x_start_m=x,
        bias_sum_counts=0,
        bias_samples=0,
    )


@kernel
def follows(trial: Trial, sample: Sample) -> bool:
    """Whether `sample` continues what the controller was in: ticks and numbers advanced alike, or no trial before and now."""
    advance = sample.number - trial.number
    if advance < 1 or trial.number < 0 or sample.time_ns < trial.time_ns:
        return False
    if sample.tick == NO_TRIAL or trial.tick == NO_TRIAL:
        return sample.tick == trial.tick
    return sample.tick - trial.tick == advance


@kernel
def advance(trial: Trial, sample: Sample, q: Triple, x: Triple) -> Trial:
    """The trial after this sample: the bias grows at negative ticks, outside a trial the start follows the pose."""
    in_trial = sample.tick != NO_TRIAL
    biasing = in_trial and sample.tick < 0
    lost = sample.number - trial.number > 1 and trial.tick < 0
    return Trial(
        number=sample.number,
        tick=sample.tick,
        time_ns=sample.time_ns,
        started=trial.started,
        whole=trial.whole and not lost,
        samples=min(trial.samples + 1, POINTS),
        q_start=trial.q_start if in_trial else q,
        x_start_m=trial.x_start_m if in_trial else x,
        bias_sum_counts=trial.bias_sum_counts + (sample.force_counts if biasing else 0),
        bias_samples=trial.bias_samples + (1 if biasing else 0),
    )


@kernel
def runs(trial: Trial, sample: Sample) -> bool:
    """Whether the law answers this sample; otherwise the controller tracks."""
    if not trial.started or sample.tick < 0:
        return False
    return sample.gate == GATE_OPEN or (sample.tick == 0 and sample.gate == GATE_SHUT)
