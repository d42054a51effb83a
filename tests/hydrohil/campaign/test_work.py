"""Rows of trials: what is measured, and how it ended."""

import pytest

from hydrohil.campaign.trials import experiment_of, trial_of
from hydrohil.campaign.work import Chunk, OtherSourcesError, chunks, row, work
from hydrohil.claims.signals import measured
from hydrohil.shared.compiled.kernel import source_version
from hydrohil.simulation.rollout import rollout
from tests.support.campaign_scene import LASTS_S, plan

PUSHED = {"claims": [{"statement": "s", "metric": "maximum", "channel": "force", "comparison": "above", "low": 1.0}]}


def test_a_row_is_what_the_trial_shows_when_it_runs_alone():
    one = plan()
    trial = trial_of(one.campaign, 8)
    found, trace = row(one, trial), rollout(experiment_of(one, trial.parameters), trial.seed)
    assert found["peak_n"] == measured(trace, "force").max()
    assert (found["ended"], found["trial"], found["seed"]) == ("completed", 8, trial.seed)
    assert found["end_s"] == trace.t_s[-1] and "claims.0" not in found


def test_the_experiments_own_claims_are_judged_where_it_is_asked():
    claim = PUSHED["claims"][0] | {"start_s": 0.0, "end_s": LASTS_S, "unit": "N"}
    one = plan(claims=True, metrics={}, set={**plan().campaign.set, "claims": [claim, claim | {"low": 1e4}]})
    found = row(one, trial_of(one.campaign, 8))
    assert (found["claims.0.holds"], found["claims.1.holds"]) == (True, False)
    assert found["claims.0"] == found["claims.1"] > 1.0


def test_a_trial_that_trips_says_why_and_leaves_what_it_did_not_reach_undetermined():
    one = plan(set={**plan().campaign.set, "supervisor.force_limit_n": 1.0})
    found = row(one, trial_of(one.campaign, 8))
    assert (found["ended"], found["cause"], found["peak_n"]) == ("tripped", "force_tared", None)
    assert "against its limit of 1.0 N" in found["message"] and found["end_s"] < LASTS_S


def test_a_trial_that_is_refused_between_the_corners_is_a_row_that_says_so():
    one = plan(sweep={"controller.tight_slew_codes": {"list": [3000]}})
    found = row(one, trial_of(one.campaign, 0))
    assert found["ended"] == "refused" and "tight_slew_codes" in found["message"]


def test_other_sources_run_nothing():
    with pytest.raises(OtherSourcesError, match="feed"):
        work(Chunk(plan(), "feed", (0,)))
    assert work(Chunk(plan(), source_version(), ())) == []


def test_chunks_have_every_number_once_in_order():
    assert chunks(range(7), 3) == [(0, 1, 2), (3, 4, 5), (6,)]
