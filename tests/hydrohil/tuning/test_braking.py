"""Step 6: ramp and sine count alike, and without braking is a choice."""

import math

import pytest

from hydrohil.shared.contract.messages import Mode
from hydrohil.tuning.braking import Braked, best_of, braking, braking_step, cost
from tests.hydrohil.claims.test_trace import standing
from tests.support.tuning_scene import GAINS, bench

WITHOUT = Braked(0.0, 2.0, 10.0, 0.5, 1.2)


def test_each_error_counts_as_a_share_of_what_it_is_without_braking():
    assert cost(WITHOUT, WITHOUT) == 1.0
    assert cost(WITHOUT._replace(ramp_q=1.0), WITHOUT) == pytest.approx(0.75)
    assert cost(WITHOUT._replace(sine_q=5.0), WITHOUT) == pytest.approx(0.75)


def test_the_least_cost_is_taken_and_no_braking_where_braking_harms():
    good, harm = WITHOUT._replace(ka_a_s_per_q=1.0, ramp_q=1.0), WITHOUT._replace(ka_a_s_per_q=2.0, ramp_q=3.0)
    assert best_of((WITHOUT, good, harm)) == good
    assert best_of((WITHOUT, harm)) == WITHOUT
    assert braking_step(bench(None), GAINS, (WITHOUT, harm), WITHOUT).gains == GAINS._replace(ka_a_s_per_q=0.0)


def test_a_trial_that_trips_is_never_the_best():
    trips = Braked(1.0, math.inf, math.inf, math.inf, math.inf)
    assert best_of((WITHOUT, trips)) == WITHOUT


def test_a_rig_that_trips_without_braking_is_refused():
    def trips(experiment, seed):
        trace = standing(1.0)
        trace.mode[-1] = Mode.TRIPPED
        return trace

    step = braking(bench(trips), GAINS)
    assert step.gains is None and "trips" in step.decision
