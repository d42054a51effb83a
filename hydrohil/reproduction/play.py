"""Trials that are played, and what their claims say of them."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from hydrohil.claims.claims import Verdict, judge, verdict
from hydrohil.claims.pairs import judge_pair
from hydrohil.claims.study import Panel, Statement, Study
from hydrohil.claims.trace import Trace
from hydrohil.experiment.experiment import Experiment
from hydrohil.reproduction.plan import Figure
from hydrohil.shared.contract.messages import Mode
from hydrohil.shared.trips.causes import trip_words
from hydrohil.simulation.rollout import Outcome, play_local, trace_of

UNPLAYED = Statement("The trials that it is computed from reach their end", "above", "1", low=1.0)


class Played(NamedTuple):
    """A trial, or why there is no verdict on it."""

    trace: Trace | None
    tripped: str = ""  # the rule, the number and its limit
    gap: str = ""  # what is missing of a live run

    @property
    def counts(self) -> bool:
        """Whether claims can be judged on it."""
        return self.trace is not None and not self.tripped and not self.gap


class Found(NamedTuple):
    """What one seed shows of a figure."""

    figure: str
    verdicts: tuple[Verdict, ...]
    panels: tuple[Panel, ...] = ()  # of a computed figure
    tripped: str = ""
    gap: str = ""


def play(experiment: Experiment, seed: int) -> Played:
    """One trial on the local clock."""
    return played(play_local(experiment, seed))


def played(outcome: Outcome) -> Played:
    """What a rollout left, as claims are judged on it."""
    trip = outcome.supervisor
    if trip.mode != Mode.TRIPPED:
        return Played(trace_of(outcome))
    return Played(trace_of(outcome), trip_words(trip.cause, trip.measured, trip.limit, trip.trip_number))


def judge_figure(figure: Figure, played: Mapping[str, Played]) -> Found:
    """Every claim of `figure`; one whose trial ended early or has a gap does not hold, and is NaN."""
    trials = [(name, played[name]) for name in figure.trials]
    tripped = "; ".join(f"{name}: {trial.tripped}" for name, trial in trials if trial.tripped)
    gap = "; ".join(f"{name}: {trial.gap}" for name, trial in trials if trial.gap)
    traces = {name: trial.trace for name, trial in trials if trial.counts and trial.trace is not None}
    if not isinstance(figure.subject, Study):
        return Found(figure=figure.name, verdicts=_of_trial(figure, figure.subject, traces), panels=(), tripped=tripped, gap=gap)
    if len(traces) < len(trials):
        return Found(figure=figure.name, verdicts=(verdict(UNPLAYED, math.nan),), panels=(), tripped=tripped, gap=gap)
    studied = figure.subject.run([traces[name] for name in figure.trials])
    return Found(figure.name, studied.verdicts, studied.panels)


def _of_trial(figure: Figure, experiment: Experiment, traces: Mapping[str, Trace]) -> tuple[Verdict, ...]:
    own = traces.get(figure.name)
    single = [verdict(claim, math.nan) if own is None else judge(claim, own) for claim in experiment.claims]
    return (*single, *(_of_pair(figure, number, traces) for number in range(len(figure.pairs))))


def _of_pair(figure: Figure, number: int, traces: Mapping[str, Trace]) -> Verdict:
    claim = figure.pairs[number]
    of, against = traces.get(claim.of), traces.get(claim.against)
    return verdict(claim, math.nan) if of is None or against is None else judge_pair(claim, of, against)


def simulated_s(experiments: Sequence[Experiment]) -> float:
    """Seconds that trials take in real time, with the removal of the force bias."""
    return sum(experiment.duration_s + experiment.plant.bias_s for experiment in experiments)
