import math

import numpy as np

from hydrohil.claims.trace import Trace
from hydrohil.reproduction.plan import find_figure
from hydrohil.reproduction.play import UNPLAYED, Played, judge_figure, play
from hydrohil.thesis.library import find

NAME = "fig-4-24"


def still(duration_s):
    """A trial in which nothing happens."""
    t_s = np.arange(0.0, duration_s, 4.5e-3)
    n = len(t_s)
    fields = {field: np.zeros((n, 3)) for field in Trace._fields} | {"t_s": t_s, "tick": np.arange(n)}
    return Trace(**{**fields, "force_n": np.zeros(n), "force_set_n": np.zeros(n), "sample_age_s": np.zeros(n)})


def test_a_figure_is_judged_claim_by_claim_and_pair_by_pair():
    figure = find_figure("fig-4-2")
    played = {name: Played(still(10.0)) for name in figure.trials}
    found = judge_figure(figure, played)
    assert [v.claim for v in found.verdicts] == [*figure.subject.claims, *figure.pairs]


def test_a_trial_that_tripped_holds_nothing_and_says_why():
    figure = find_figure(NAME)
    found = judge_figure(figure, {NAME: Played(still(10.0), tripped="too much")})
    assert found.tripped == f"{NAME}: too much"
    assert not any(v.holds for v in found.verdicts) and all(math.isnan(v.measured) for v in found.verdicts)


def test_a_pair_whose_other_trial_has_a_gap_does_not_hold_but_its_own_claims_are_judged():
    figure = find_figure("fig-4-2")
    found = judge_figure(figure, {"fig-4-2": Played(still(10.0)), "fig-4-21": Played(None, gap="tick 3 is missing")})
    assert found.gap == "fig-4-21: tick 3 is missing"
    assert math.isnan(found.verdicts[-1].measured) and not math.isnan(found.verdicts[0].measured)


def test_a_study_of_a_trial_without_a_verdict_is_not_computed():
    figure = find_figure("fig-4-14")
    (only,) = judge_figure(figure, {"fig-4-9": Played(None, gap="tick 3 is missing")}).verdicts
    assert only.claim is UNPLAYED and not only.holds


def test_a_study_without_trials_brings_panels_and_verdicts():
    found = judge_figure(find_figure("fig-4-12"), {})
    assert found.panels and found.verdicts


def test_a_local_trial_is_played_to_its_end_and_a_trip_is_reported_in_words():
    experiment = find(NAME)
    played = play(experiment, 0)
    assert played.counts and played.trace.t_s[-1] > experiment.duration_s - 0.1
    tripped = play(find("fig-5-5")._replace(supervisor=find("fig-5-5").supervisor._replace(force_limit_n=50.0)), 0)
    assert not tripped.counts and "against its limit of 50.0 N" in tripped.tripped
