"""The timing of a trial from its samples, and percentiles."""

import math
from random import Random

import pytest

from hydrohil.qualification.samples import timing, worst_window
from hydrohil.qualification.spread import Spread, spread
from hydrohil.shared.contract.messages import NO_TRIAL
from tests.support.supervisor_scene import sample

FIRST = 40  # number of the sample of tick 0


def trial(ticks: int, **changed: dict) -> list:
    """Samples from before a trial to after it, each saying that the one before it was answered after 900 us."""
    samples = []
    for number in range(FIRST - 3, FIRST + ticks + 2):
        tick = number - FIRST if number - FIRST < ticks else NO_TRIAL
        fields = {"command_number": number - 1, "command_age_ns": 900_000} | changed.get(f"n{number - FIRST}", {})
        samples.append(sample(number, tick, **fields))
    return samples


def test_every_tick_is_judged_by_the_sample_that_follows_it():
    observed = timing(trial(5), 5)
    assert observed.in_time == (True,) * 5
    assert observed.accepted_us == (900.0,) * 5
    assert observed.missing == 0


def test_an_answer_that_took_effect_late_is_not_in_time_but_was_accepted():
    observed = timing(trial(5, n3={"command_late_substeps": 1, "command_age_ns": 3_700_000}), 5)
    assert observed.in_time == (True, True, False, True, True)
    assert observed.accepted_us == (900.0, 900.0, 3700.0, 900.0, 900.0)


def test_a_tick_without_an_answer_was_neither():
    observed = timing(trial(5, n5={"command_number": FIRST + 3}), 5)
    assert observed.in_time == (True, True, True, True, False)
    assert len(observed.accepted_us) == 4


def test_a_sample_that_was_not_received_leaves_its_tick_and_the_one_before_unproven():
    received = [sample for sample in trial(5) if sample.tick != 2]
    observed = timing(received, 5)
    assert observed.in_time == (True, False, False, True, True)
    assert observed.missing == 1


def test_without_samples_nothing_is_in_time():
    assert timing([], 3) == ((False, False, False), (), 3)


def test_fewer_than_100_ticks_have_no_window():
    assert math.isnan(worst_window([True] * 99))
    assert worst_window([True] * 100) == 1.0


def test_the_worst_window_is_the_worst_of_all():
    rng = Random(3)
    for _ in range(20):
        flags = [rng.random() < 0.9 for _ in range(rng.randrange(100, 400))]
        assert worst_window(flags) == min(sum(flags[i : i + 100]) for i in range(len(flags) - 99)) / 100


@pytest.mark.parametrize("where", [0, 150, 299])
def test_a_burst_counts_wherever_it_is(where: int):
    flags = [True] * 300
    flags[where] = False
    assert worst_window(flags) == 0.99


def test_percentiles_are_values_that_were_measured():
    assert spread([float(i) for i in range(1000)]) == Spread(500.0, 990.0, 999.0, 999.0)
    assert spread([7.0]) == Spread(7.0, 7.0, 7.0, 7.0)
    assert all(map(math.isnan, spread([])))
