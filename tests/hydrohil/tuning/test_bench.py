"""What counts as ringing, and what a bench plays."""

import pytest

from hydrohil.shared.units import A_PER_MA, RAD_PER_DEG
from hydrohil.tuning.bench import Criteria, a_per_printed, play, rad_per_unit, rings_on, unit
from hydrohil.tuning.measure import Ringing
from hydrohil.tuning.patterns import pattern
from tests.hydrohil.claims.test_trace import standing
from tests.support.tuning_scene import GAINS, LINK, bench

CRITERIA = Criteria()
LEAST, DECAY = CRITERIA.ripple_counts, CRITERIA.decay


@pytest.mark.parametrize(
    ("early", "late", "on"),
    [
        (0.3, 0.3, False),  # the encoder's sawtooth
        (0.1, LEAST, False),
        (0.1, LEAST + 0.01, True),
        (10.0, 10.0 * DECAY, False),
        (10.0, 10.0 * DECAY + 0.01, True),
        (10.0, 9.9, True),  # a limit cycle at its full size
    ],
)
def test_ringing_that_has_not_lost_its_share_rings_on(early, late, on):
    assert rings_on(CRITERIA, Ringing(early, late)) == on


def test_one_trial_a_seed_is_played_until_one_trips():
    played = []

    def run(experiment, seed):
        played.append((experiment.name, seed))
        return standing(experiment.duration_s if seed < 2 else 1.0)

    setpoint = pattern("small-step", LINK, GAINS)
    assert len(play(bench(run, seeds=2), "pi", GAINS, setpoint) or ()) == 2
    assert play(bench(run, seeds=4), "pi", GAINS, setpoint) is None
    assert [seed for _, seed in played] == [0, 1, 0, 1, 2]
    assert {name for name, _ in played} == {"tune-q2"}


def test_gains_are_printed_in_the_units_of_table_2():
    assert (unit(0), unit(1), unit(2)) == ("deg", "deg", "m")
    assert (rad_per_unit(1), rad_per_unit(2)) == (RAD_PER_DEG, 1.0)
    assert GAINS.kp_a_per_q / a_per_printed(1) == pytest.approx(215.0)
    assert a_per_printed(2) == A_PER_MA
