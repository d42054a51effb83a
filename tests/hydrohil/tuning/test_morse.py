"""Steps 3 and 4: which of the values tried is taken."""

import math

import pytest

from hydrohil.tuning.bench import Criteria
from hydrohil.tuning.morse import Tuned, alpha_step, best_alpha, best_integral, integral_step, suffers
from hydrohil.tuning.search import Found, Tried
from tests.support.tuning_scene import GAINS, bench

CRITERIA = Criteria()
FINE = (0.1, 0.3, 0.3, 1.0, 2.0, 1.0)  # error, ripple early and late, turns, overshoot, swing


def tried(value, error, passed=True):
    return Tried(value, passed, (error, *FINE[1:]))


def test_of_the_integral_gains_that_pass_the_one_of_least_error_is_taken():
    inside = Found((tried(1.0, 0.5), tried(2.0, 0.2), tried(3.0, 0.3), tried(4.0, 0.1, passed=False)), True)
    assert best_integral(inside).value == 2.0
    assert best_integral(Found((tried(1.0, 0.5, passed=False),), True)) is None


@pytest.mark.parametrize(("cost", "alpha"), [(0.0, 8.0), (0.05, 4.0), (0.5, 2.0)])
def test_the_smallest_alpha_within_the_cost_is_taken(cost, alpha):
    alphas = (tried(1.0, 0.1, passed=False), tried(2.0, 0.14), tried(4.0, 0.105), tried(8.0, 0.1), tried(16.0, 0.1001))
    assert best_alpha(alphas, cost).value == alpha


def test_without_an_alpha_that_passes_there_is_none():
    assert best_alpha((tried(1.0, 0.1, passed=False),), 0.1) is None


@pytest.mark.parametrize(
    ("field", "on", "past", "phrase"),
    [
        (3, CRITERIA.hunting, CRITERIA.hunting + 1.0, "hunts"),
        (4, CRITERIA.overshoot_counts, CRITERIA.overshoot_counts + 0.01, "small step"),
        (5, CRITERIA.swing_ratio, CRITERIA.swing_ratio + 1e-3, "sine"),
        (2, CRITERIA.ripple_counts, CRITERIA.ripple_counts + 0.01, "rings"),
    ],
)
def test_a_pattern_suffers_just_past_its_limit_and_is_named(field, on, past, phrase):
    numbers = list(FINE)
    numbers[field] = float(on)
    assert suffers(CRITERIA, tuple(numbers)) == ""
    numbers[field] = past
    assert phrase in suffers(CRITERIA, tuple(numbers))


def test_a_trial_that_trips_suffers():
    assert "trips" in suffers(CRITERIA, (math.inf,) * 6)


def test_step_3_names_what_keeps_the_gain_from_being_larger():
    limited = Found((tried(1.0, 0.5), tried(2.0, 0.2), Tried(3.0, False, (*FINE[:5], 1.2))), True)
    assert "sine's large swings overshoot by 20" in integral_step(bench(None), Tuned(limited, GAINS, (), GAINS)).decision
    inside = Found((tried(1.0, 0.1), tried(2.0, 0.2), Tried(3.0, False, (*FINE[:5], 1.2))), True)
    assert "least there" in integral_step(bench(None), Tuned(inside, GAINS, (), GAINS)).decision


def test_where_every_alpha_fails_it_is_step_4_that_found_nothing():
    found = Found((tried(1.0, 0.1),), False)
    none = Tuned(found, GAINS, (tried(1.0, 0.1, passed=False),), None)
    assert integral_step(bench(None), none).gains == GAINS
    assert alpha_step(bench(None), none).gains is None and alpha_step(bench(None), none).number == 4
