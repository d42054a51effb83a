import math

import numpy as np
import pytest

from hydrohil.claims.claims import UNITS, Claim, band, dimension, judge, problems
from hydrohil.claims.signals import COUNT_Q
from hydrohil.shared.units import RAD_PER_DEG
from tests.hydrohil.claims.test_trace import link, standing

CLAIM = Claim(
    "the force is 100 N",
    metric="mean",
    channel="force",
    comparison="within",
    start_s=1.0,
    end_s=2.0,
    unit="N",
    low=94.0,
    high=106.0,
)


def pushing(force_n, duration_s=3.0):
    trace = standing(duration_s)
    return trace._replace(force_n=np.full(len(trace.t_s), force_n))


@pytest.mark.parametrize(
    ("force_n", "holds"), [(94.0, True), (93.999, False), (106.0, True), (106.001, False), (math.nan, False)]
)
def test_a_band_holds_on_its_limits_and_not_just_past_them(force_n, holds):
    verdict = judge(CLAIM, pushing(force_n))
    assert verdict.holds is holds
    assert verdict.claim is CLAIM
    assert verdict.measured == pytest.approx(force_n, nan_ok=True)


@pytest.mark.parametrize(("comparison", "on", "past"), [("below", 106.0, 106.1), ("above", 94.0, 93.9)])
def test_one_sided_bands_look_at_their_own_limit_only(comparison, on, past):
    claim = CLAIM._replace(comparison=comparison)
    assert judge(claim, pushing(on)).holds
    assert not judge(claim, pushing(past)).holds
    far = -1e6 if comparison == "below" else 1e6
    assert judge(claim, pushing(far)).holds
    assert not judge(claim, pushing(math.nan)).holds


def test_two_counts_measured_as_a_difference_of_angles_are_two_counts():
    trace = standing(3.0)
    trace = trace._replace(q_set=trace.q_set + 0.3, q=trace.q + (0.3 - 2.0 * COUNT_Q[1]))
    claim = CLAIM._replace(metric="steady_error_counts", channel="q2", unit="counts", comparison="below", high=2.0)
    assert judge(claim, trace).holds
    assert not judge(claim._replace(high=1.999), trace).holds


def test_only_the_window_is_judged():
    trace = pushing(100.0)
    outside = (trace.t_s < 1.0) | (trace.t_s > 2.0)
    assert judge(CLAIM, trace._replace(force_n=np.where(outside, 1e4, 100.0))).measured == 100.0


def test_an_empty_window_does_not_hold():
    verdict = judge(CLAIM, pushing(100.0, duration_s=0.9))
    assert math.isnan(verdict.measured) and not verdict.holds


def test_a_trial_that_ended_within_the_window_does_not_hold():
    assert not judge(CLAIM, pushing(100.0, duration_s=1.88)).holds
    assert judge(CLAIM, pushing(100.0, duration_s=2.0)).holds


def test_the_measured_number_is_in_the_claims_unit():
    trace = standing(3.0)
    trace = trace._replace(q=link(np.full(len(trace.t_s), 0.5 * RAD_PER_DEG), 2), q_set=trace.q_set)
    claim = CLAIM._replace(metric="max_error", channel="q2")
    assert judge(claim._replace(unit="deg"), trace).measured == pytest.approx(0.5)
    assert judge(claim._replace(unit="rad"), trace).measured == pytest.approx(0.5 * RAD_PER_DEG)
    counts = claim._replace(metric="steady_error_counts", unit="counts")
    assert judge(counts, trace).measured == pytest.approx(0.5 * RAD_PER_DEG / COUNT_Q[1])
    percent = CLAIM._replace(metric="steady_error", unit="%")
    assert judge(percent, pushing(94.0)._replace(force_set_n=np.full(668, 100.0))).measured == pytest.approx(6.0)


def test_dimensions_follow_the_channel():
    assert [dimension("maximum", channel) for channel in ("q2", "q3", "z", "force")] == ["angle", "length", "length", "force"]
    assert dimension("control_peak", "q2") == "current"


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"unit": "mm"}, "unit"),
        ({"metric": "control_peak", "unit": "mA"}, "channel"),
        ({"low": 107.0}, "low"),
        ({"start_s": 2.0}, "end_s"),
        ({"end_s": 3.1}, "end_s"),
    ],
)
def test_an_inconsistent_claim_is_named_by_field(changes, field):
    assert problems(CLAIM, 3.0) == []
    assert [name for name, _ in problems(CLAIM._replace(**changes), 3.0)] == [field]


def test_a_band_reads_as_words():
    assert band(CLAIM) == "within 94..106 N"
    assert band(CLAIM._replace(comparison="below", unit="%")) == "below 106 %"
    dimensions = {"angle", "length", "force", "current", "time", "rate", "number", "stiffness", "speed"}
    assert {dimension for dimension, _ in UNITS.values()} == dimensions
