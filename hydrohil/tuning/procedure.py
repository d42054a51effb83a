"""The six steps of Appendix C on one link, unattended, and what the gains achieve on the five patterns."""

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from hydrohil.experiment.experiment import checked
from hydrohil.experiment.sections import LinkGains
from hydrohil.thesis.chapter4 import PATTERNS
from hydrohil.thesis.chapter4 import Pattern as PatternName
from hydrohil.tuning import measure
from hydrohil.tuning.bench import Bench, Step, middle, play
from hydrohil.tuning.braking import braking
from hydrohil.tuning.linear import integral, proportional
from hydrohil.tuning.morse import morse
from hydrohil.tuning.patterns import pattern, trial
from hydrohil.tuning.stiction import stiction

STEPS = 6
PROCEDURE: tuple[Callable[[Bench, LinkGains], tuple[Step, ...]], ...] = (
    lambda bench, gains: (proportional(bench, gains),),
    lambda bench, gains: (integral(bench, gains),),
    morse,  # steps 3 and 4
    lambda bench, gains: (stiction(bench, gains),),
    lambda bench, gains: (braking(bench, gains),),
)


class Worth(NamedTuple):
    """Median rms error of the final law on one pattern, with two sets of gains; infinite where a trial trips."""

    pattern: str
    before_q: float
    tuned_q: float


class LinkTuning(NamedTuple):
    """One link's steps; no gains if a step found no acceptable value, which then is the last."""

    link: int
    steps: tuple[Step, ...]
    gains: LinkGains | None
    worth: tuple[Worth, ...]


def check_place(bench: Bench) -> None:
    """Raise ExperimentError if the patterns leave the link's travel."""
    gains = bench.experiment.controller.gains[bench.link]
    for name in PATTERNS:
        experiment = trial(bench.experiment, bench.link, "final", gains, pattern(name, bench.link, gains), middle(bench))
        checked(experiment, f"tune {experiment.name[len('tune-') :]}")


def steps(bench: Bench) -> Iterator[Step]:
    """Yield each step when it is done; the last is the sixth, or the one that found no acceptable value."""
    gains = bench.experiment.controller.gains[bench.link]
    for do in PROCEDURE:
        for step in do(bench, gains):
            yield step
            if step.gains is None:
                return
            gains = step.gains


def worth(bench: Bench, tuned: LinkGains) -> tuple[Worth, ...]:
    """The final law on the five patterns, with the experiment's own gains and with the tuned ones."""
    before = bench.experiment.controller.gains[bench.link]
    return tuple(Worth(name, _error_q(bench, before, name), _error_q(bench, tuned, name)) for name in PATTERNS)


def _error_q(bench: Bench, gains: LinkGains, name: PatternName) -> float:
    traces = play(bench, "final", gains, pattern(name, bench.link, gains))
    return math.inf if traces is None else float(np.median([measure.rms_error_q(trace, bench.link) for trace in traces]))


def tune_link(bench: Bench, watch: Callable[[int, Step], None] = lambda link, step: None) -> LinkTuning:
    """Tune one link; `watch` is called with the link and each step.

    Raises ExperimentError if the patterns do not fit into the link's travel.
    """
    check_place(bench)
    done: list[Step] = []
    for step in steps(bench):
        done.append(step)
        watch(bench.link, step)
    gains = done[-1].gains
    return LinkTuning(bench.link, tuple(done), gains, () if gains is None else worth(bench, gains))
