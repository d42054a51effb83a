"""Steps 1 and 2 on links whose stability limit is known, and on traces of none."""

import math

import pytest

from hydrohil.shared.contract.messages import Mode
from hydrohil.tuning.bench import Criteria
from hydrohil.tuning.linear import integral_step, proportional, proportional_step
from hydrohil.tuning.search import Found, Tried
from tests.hydrohil.claims.test_trace import standing
from tests.support.tuning_scene import GAINS, bench, resonant, stuck_until

SPEED = 1.0  # rad/s a A


@pytest.mark.parametrize(("frequency_hz", "damping"), [(6.0, 0.1), (10.0, 0.1), (10.0, 0.2), (15.0, 0.1)])
def test_the_stability_limit_of_a_resonant_link_is_found_within_15_percent(frequency_hz, damping):
    run, limit = resonant(SPEED, frequency_hz, damping)
    step = proportional(bench(run), GAINS)
    assert step.gains.kp_a_per_q * Criteria().margin == pytest.approx(limit, rel=0.15)


def test_twice_the_flow_gain_halves_the_gain():
    slow, fast = (proportional(bench(resonant(speed, 10.0, 0.2)[0]), GAINS).gains for speed in (1.0, 2.0))
    assert slow.kp_a_per_q / fast.kp_a_per_q == pytest.approx(2.0, rel=0.1)


def test_a_link_that_never_moves_has_no_maximum_gain_and_the_step_says_so():
    step = proportional(bench(stuck_until(math.inf, math.inf)), GAINS)
    assert step.gains is None
    assert "does the link move?" in step.decision
    assert len(step.rows) > 5


def test_a_rig_that_trips_at_once_leaves_its_trials_as_evidence():
    def trips(experiment, seed):
        trace = standing(1.0)
        trace.mode[-1] = Mode.TRIPPED
        return trace

    step = proportional(bench(trips), GAINS)
    assert step.gains is None
    assert all(row[-1] == "no" and row[1] == math.inf for row in step.rows)


def found(share):
    return Found((Tried(1.0, True, (0.3, 0.3, 0.0, share)), Tried(1.1, False, (1.0, 2.0, 0.0, 1.0))), True)


def test_a_link_that_is_too_slow_for_the_ramp_is_refused_with_what_to_do():
    assert proportional_step(bench(None), GAINS, found(0.91)).gains is not None
    slow = proportional_step(bench(None), GAINS, found(0.89))
    assert slow.gains is None and "qd_max_rad_per_s" in slow.decision


def test_the_gain_taken_lies_the_margin_below_the_largest_stable():
    taken = proportional_step(bench(None)._replace(criteria=Criteria(margin=2.0)), GAINS, found(1.0)).gains
    assert taken.kp_a_per_q == 0.5
    assert taken == GAINS._replace(kp_a_per_q=0.5)


def test_step_2_takes_the_largest_that_passed_and_changes_nothing_else():
    tried = tuple(Tried(value, value < 3.0, (0.1, 0.3, 0.3, 0.0, 0.01)) for value in (1.0, 2.0, 4.0))
    step = integral_step(bench(None), GAINS, Found(tried, True))
    assert step.gains == GAINS._replace(linear_ki_a_per_q_s=2.0)
    assert [row[-1] for row in step.rows] == ["yes", "yes", "no"]
    assert integral_step(bench(None), GAINS, Found(tried[2:], True)).gains is None
