"""Two faults at once (row 34), on the local clock: the bound of the one that shows by itself holds for both."""

import math
from itertools import combinations
from typing import NamedTuple

from hydrohil.faulttest.motions import SWING
from hydrohil.faulttest.simulations import PLAYED_S, at, first_with, period_s, timed
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.contract.faults import Fault
from hydrohil.simulation.rollout import play_local


class Single(NamedTuple):
    """One fault and the bound that its own row states."""

    words: str
    kind: str
    target: str
    value: float
    bound_s: float
    periods: float  # T more


SINGLES = (
    Single("gauge off", "dropout", "force", 0.0, 0.0, 1.0),
    Single("force saturated", "offset", "force", 1000.0, 0.0, 1.0),
    Single("force stuck", "stuck", "force", 0.0, 0.1, 0.0),
    Single("force jumps", "offset", "force", 150.0, 0.1, 0.0),
    Single("encoder off", "dropout", "encoder_down_up", 0.0, 0.0, 2.0),
    Single("encoder jumps", "offset", "encoder_down_up", 200.0, 0.0, 2.0),
    Single("spool stuck", "stuck", "valve_down_up", 0.0, math.nan, 0.0),  # shown by a current that must move the link, whose
    Single("supply lost", "drop", "supply", 1.0, math.nan, 0.0),  # instant is not the fault's
)
PAIRS = tuple(
    (a, b) for a, b in combinations(SINGLES, 2) if a.target != b.target
)  # of one sensor the later fault hides the other


def paired(seed: int) -> Trial:
    """Every pair, both begun at the same instant; the slowest against its bound, and all that failed in words."""
    trials = [(f"{a.words} and {b.words}", _both(seed, a, b)) for a, b in PAIRS]
    failed = [f"{words}: {trial.words}" for words, trial in trials if not trial.held]
    words, worst = max(trials, key=lambda one: one[1].reaction_s)
    told = "; ".join(failed) or f"{len(PAIRS)} pairs; the slowest: {words}: {worst.words}"
    return worst._replace(held=not failed, words=told)


def _both(seed: int, a: Single, b: Single) -> Trial:
    at_s = at(seed)
    faults = tuple(Fault(one.kind, one.target, at_s, 0.0, one.value) for one in (a, b))
    experiment = SWING._replace(duration_s=PLAYED_S, faults=faults)
    outcome = play_local(experiment, seed)
    bounds_s = [one.bound_s + one.periods * period_s(experiment) for one in (a, b) if math.isfinite(one.bound_s)]
    bound_s = max(bounds_s, default=math.nan)
    return timed(experiment, outcome, first_with(experiment, outcome), bound_s)
