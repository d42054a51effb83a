import math

import numpy as np
import pytest

from hydrohil.claims.pairs import PairClaim, judge_pair
from tests.hydrohil.claims.test_trace import standing

RATIO = PairClaim(
    "",
    of="one",
    against="other",
    measure="metric_ratio",
    channel="force",
    comparison="below",
    start_s=1.0,
    end_s=2.0,
    unit="1",
    metric="mean",
    high=0.5,
)
APART = PairClaim(
    "",
    of="one",
    against="other",
    measure="rms_difference",
    channel="force",
    comparison="below",
    start_s=1.0,
    end_s=2.0,
    unit="N",
    high=3.0,
)


def pushing(force_n, duration_s=3.0):
    trace = standing(duration_s)
    return trace._replace(force_n=np.full(len(trace.t_s), force_n))


@pytest.mark.parametrize(("force_n", "holds"), [(50.0, True), (50.1, False)])
def test_a_ratio_is_the_first_over_the_second_and_holds_on_its_limit(force_n, holds):
    verdict = judge_pair(RATIO, pushing(force_n), pushing(100.0))
    assert verdict.measured == pytest.approx(force_n / 100.0)
    assert verdict.holds is holds


def test_a_ratio_to_nothing_does_not_hold():
    verdict = judge_pair(RATIO, pushing(50.0), pushing(0.0))
    assert math.isnan(verdict.measured) and not verdict.holds


@pytest.mark.parametrize(("force_n", "holds"), [(103.0, True), (96.9, False)])
def test_signals_are_set_side_by_side_in_the_claims_unit(force_n, holds):
    assert judge_pair(APART, pushing(force_n), pushing(100.0)).holds is holds


@pytest.mark.parametrize("claim", [RATIO, APART])
@pytest.mark.parametrize("ended_s", [0.9, 1.88])
def test_a_pair_of_which_one_trial_ended_within_the_window_does_not_hold(claim, ended_s):
    short, whole = pushing(50.0, ended_s), pushing(100.0 if claim is RATIO else 50.0)
    for one, other in ((short, whole), (whole, short)):
        verdict = judge_pair(claim, one, other)
        assert math.isnan(verdict.measured) and not verdict.holds
    assert judge_pair(claim, pushing(50.0, 2.0), whole).holds
