"""Two faults at once (row 34), on the local clock: the bound of the fault that is detected by itself holds for both."""

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
    Single(words="gauge off", kind="dropout", target="force", value=0.0, bound_s=0.0, periods=1.0),
    Single(words="force saturated", kind="offset", target="force", value=1000.0, bound_s=0.0, periods=1.0),
    Single(words="force stuck", kind="stuck", target="force", value=0.0, bound_s=0.1, periods=0.0),
    Single(words="force jumps", kind="offset", target="force", value=150.0, bound_s=0.1, periods=0.0),
    Single(words="encoder off", kind="dropout", target="encoder_down_up", value=0.0, bound_s=0.0, periods=2.0),
    Single(words="encoder jumps", kind="offset", target="encoder_down_up", value=200.0, bound_s=0.0, periods=2.0),
    # these two are detected by a current that must move the link; that instant is not the fault's, so no time is bounded
    Single(words="spool stuck", kind="stuck", target="valve_down_up", value=0.0, bound_s=math.nan, periods=0.0),
    Single(words="supply lost", kind="drop", target="supply", value=1.0, bound_s=math.nan, periods=0.0),
)
PAIRS = tuple(
    (a, b) for a, b in combinations(SINGLES, 2) if a.target != b.target
)  # of one sensor the later fault hides the other


def paired(seed: int) -> Trial:
    """Every pair, both begun at the same instant; the slowest against its bound, and all that failed in words."""
    trials = [(f"{a.words} and {b.words}", _both(seed, a, b)) for a, b in PAIRS]
    failed = [f"{words}: {trial.words}" for words, trial in trials if not trial.held]
    words, worst = max(trials, key=lambda one: one[1].reaction_s)
    summary = "; ".join(failed) or f"{len(PAIRS)} pairs; the slowest: {words}: {worst.words}"
    return worst._replace(held=not failed, words=summary)


def _both(seed: int, a: Single, b: Single) -> Trial:
    at_s = at(seed)
    faults = tuple(Fault(kind=one.kind, target=one.target, at_s=at_s, lasts_s=0.0, value=one.value) for one in (a, b))
    experiment = SWING._replace(duration_s=PLAYED_S, faults=faults)
    outcome = play_local(experiment, seed)
    bounds_s = [one.bound_s + one.periods * period_s(experiment) for one in (a, b) if math.isfinite(one.bound_s)]
    bound_s = max(bounds_s, default=math.nan)
    return timed(experiment, outcome, first_with(experiment, outcome), bound_s)
