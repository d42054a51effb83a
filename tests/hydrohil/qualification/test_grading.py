"""The rule by which a rate is qualified: on each limit, just past it, and with each number missing."""

import math

import pytest

from hydrohil.qualification.grading import (
    GRADES,
    RULE,
    Figures,
    Verdict,
    deciding_period_ns,
    floor,
    is_evidence,
    judge,
    qualified_period_ns,
)
from hydrohil.qualification.spread import Spread
from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.services.supervisor.params import limits
from hydrohil.shared.host.lease import MAX_LEASE_NS
from tests.support.qualification_scene import FINE, GOOD, PERIOD_NS, worst
from tests.support.supervisor_scene import DESCRIPTION

QUALIFIED, NOT = Verdict("B", True, ()), Verdict("C", False, ("late",))


def test_a_host_on_which_nothing_is_late_is_graded_a():
    assert judge(GOOD) == Verdict("A", True, ())


def test_what_was_not_measured_at_all_is_not_qualified():
    assert judge(Figures(PERIOD_NS)).grade == "D"


@pytest.mark.parametrize(
    ("on", "past", "grade"),
    [
        ({"unanswered": 4.0}, {"unanswered": 5.0}, "C"),
        ({"shifts": 4.0}, {"shifts": 5.0}, "C"),
        ({"unanswered": 2.0, "shifts": 2.0}, {"unanswered": 2.0, "shifts": 3.0}, "C"),
        ({"lost": 4.0}, {"lost": 5.0}, "C"),
        ({"samples": 1000}, {"samples": 999}, "C"),
        ({"worst_window": floor(PERIOD_NS)}, {"worst_window": floor(PERIOD_NS) - 0.01}, "D"),
        ({"wake_ups_us": worst(66_666.0)}, {"wake_ups_us": worst(66_667.0)}, "D"),
        ({"grid_us": worst(66_666.0)}, {"grid_us": worst(66_667.0)}, "D"),
        ({"ended": ""}, {"ended": "the gate has cut"}, "D"),
    ],
)
def test_a_rate_is_qualified_on_each_limit_and_not_just_past_it(on: dict, past: dict, grade: str):
    assert judge(GOOD._replace(**on)).qualified
    verdict = judge(GOOD._replace(**past))
    assert (verdict.grade, verdict.qualified, len(verdict.reasons)) == (grade, False, 1)


@pytest.mark.parametrize(
    "field", ["unanswered", "shifts", "lost", "worst_window", "wake_ups_us", "limit_us", "ping_us", "accepted_us", "grid_us"]
)
def test_a_number_that_is_missing_is_not_qualified(field: str):
    missing = Spread() if isinstance(getattr(GOOD, field), Spread) else math.nan
    assert not judge(GOOD._replace(**{field: missing})).qualified


@pytest.mark.parametrize("field", Spread._fields)
def test_an_infinite_percentile_is_not_qualified(field: str):
    assert not judge(GOOD._replace(accepted_us=FINE._replace(**{field: math.inf}))).qualified


@pytest.mark.parametrize(
    "changes",
    [
        {"unanswered": 1.0},
        {"shifts": 1.0},
        {"lost": 1.0},
        {"late_permits": 1.0},
        {"late_permits": math.nan},
        {"wake_ups_us": worst(6_667.0)},
        {"grid_us": worst(6_667.0)},
    ],
)
def test_one_late_sample_or_a_lease_above_20_ms_is_grade_b(changes: dict):
    assert judge(GOOD._replace(**changes)) == QUALIFIED


def test_a_worst_wake_up_for_which_20_ms_suffice_is_still_grade_a():
    assert judge(GOOD._replace(wake_ups_us=worst(6_666.0))).grade == "A"


def test_every_reason_says_its_number():
    worse = GOOD._replace(unanswered=40.0, lost=50.0, worst_window=0.5, wake_ups_us=worst(70_000.0))
    text = "\n".join(judge(worse).reasons)
    assert all(word in text for word in ("1.00%", "50 frames", "50%", "210 ms", f"{MAX_LEASE_NS // 1_000_000}"))
    everything = judge(Figures(PERIOD_NS)).reasons
    assert len(everything) == len(RULE) and all(everything) and "nan" not in " ".join(everything)
    assert [reason.endswith("not measured") for reason in everything] == [False, True, True, True, False, True, True]


def test_the_floor_is_the_supervisors_own_at_the_lease_of_industrial_arms():
    description = DESCRIPTION._replace(permit_ttl_ns=20_000_000)
    for period_ns in (1_000_000, 2_000_000, PERIOD_NS, 10_000_000):
        missed = limits(SupervisorConfig(), description._replace(sample_period_ns=period_ns)).missed_samples
        assert floor(period_ns) == (100 - missed) / 100


def test_every_grade_has_words():
    assert set(GRADES) == {"A", "B", "C", "D"}


@pytest.mark.parametrize(
    ("verdicts", "qualified", "deciding"),
    [
        ({1: NOT, 2: NOT, 4: NOT}, 0, 4),
        ({1: NOT, 2: QUALIFIED, 4: QUALIFIED}, 2, 2),
        ({1: QUALIFIED, 2: QUALIFIED}, 1, 1),
        ({1: QUALIFIED, 2: NOT, 4: QUALIFIED}, 4, 4),
        ({1: QUALIFIED, 4: NOT}, 0, 4),
        ({2: QUALIFIED}, 2, 2),
    ],
)
def test_the_highest_qualified_rate_has_no_lower_one_that_failed(verdicts: dict, qualified: int, deciding: int):
    assert qualified_period_ns(verdicts) == qualified
    assert deciding_period_ns(verdicts) == deciding


@pytest.mark.parametrize(("samples", "ended", "says"), [(1000, "", True), (999, "", False), (10, "the gate has cut", True)])
def test_a_trial_says_something_if_it_was_long_enough_or_ended_badly(samples: int, ended: str, says: bool):
    assert is_evidence(GOOD._replace(samples=samples, ended=ended)) == says
