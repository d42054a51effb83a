"""Step 5 on a link that breaks loose at known currents, and on emulated ones with other friction."""

import math

import pytest

from hydrohil.experiment.overrides import with_overrides
from hydrohil.shared.units import A_PER_MA
from hydrohil.simulation.rollout import rollout
from hydrohil.tuning.stiction import FAST_A_PER_S, SLOW_A_PER_S, Breakaway, stiction, stiction_step
from tests.hydrohil.claims.test_trace import standing
from tests.support.tuning_scene import EXPERIMENT, GAINS, bench, stuck_until


@pytest.mark.parametrize(("positive_ma", "negative_ma"), [(88.0, 114.0), (40.0, 40.0), (200.0, 60.0)])
def test_the_break_away_of_each_direction_is_found(positive_ma, negative_ma):
    tuned = stiction(bench(stuck_until(positive_ma * A_PER_MA, negative_ma * A_PER_MA)), GAINS).gains
    assert tuned.boost_positive_a == pytest.approx(positive_ma * A_PER_MA, rel=0.01)
    assert tuned.boost_negative_a == pytest.approx(negative_ma * A_PER_MA, rel=0.01)


def test_vetia_goes_on_firing_at_the_same_share_of_the_weaker_threshold():
    tuned = stiction(bench(stuck_until(0.06, 0.2)), GAINS).gains
    share = GAINS.boost_below_a / min(GAINS.boost_positive_a, GAINS.boost_negative_a)
    assert tuned.boost_below_a == pytest.approx(share * 0.06, rel=0.01)
    none_before = GAINS._replace(boost_positive_a=0.0, boost_negative_a=0.0)
    assert stiction(bench(stuck_until(0.06, 0.2)), none_before).gains.boost_below_a == pytest.approx(0.06, rel=0.01)


def test_a_link_that_sticks_beyond_the_slow_ramps_is_refused():
    step = stiction(bench(lambda experiment, seed: standing(experiment.duration_s)), GAINS)
    assert step.gains is None and "stuck" in step.decision


def test_the_threshold_is_the_median_of_the_places_at_the_slow_rate():
    slow = [Breakaway(0.1 * n, SLOW_A_PER_S, way, current) for way in (1, -1) for n, current in enumerate((0.3, 0.1, 0.09))]
    fast = [Breakaway(0.0, FAST_A_PER_S, way, 9.0) for way in (1, -1)]
    tuned = stiction_step(bench(None), GAINS, (*slow, *fast)).gains
    assert (tuned.boost_positive_a, tuned.boost_negative_a) == (0.1, 0.1)
    assert stiction_step(bench(None), GAINS, (slow[0]._replace(current_a=math.nan), *slow[1:], *fast)).gains is None


def emulated(*settings):
    changed = bench(rollout)._replace(experiment=with_overrides(EXPERIMENT, settings))
    tuned = stiction(changed, GAINS).gains
    return tuned.boost_positive_a / A_PER_MA, tuned.boost_negative_a / A_PER_MA


def test_the_emulated_unimate_breaks_away_within_a_twentieth_of_table_2():
    assert emulated() == pytest.approx((88.0, 114.0), rel=0.05)


def test_thresholds_follow_the_friction_of_the_plant():
    link = "plant.machine.down_up"
    weaker, normal, stronger = (emulated(f"{link}.breakaway_nm={fs}", f"{link}.coulomb_nm=80.0") for fs in (235.0, 470.0, 940.0))
    assert weaker[0] < normal[0] < stronger[0] and weaker[1] < normal[1] < stronger[1]
    unequal = [up - down for down, up in (weaker, normal, stronger)]
    assert max(unequal) - min(unequal) < 0.2 * max(unequal)  # weight and null bias, which friction does not change
