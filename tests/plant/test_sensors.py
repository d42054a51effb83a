import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.services.plant.params import UNIMATE_PARAMS
from hydrohil.services.plant.sensors import MASK, N_PER_COUNT, OFFSET, SCALE, encoder_count, encoder_counts, gauge_counts

QUIET = UNIMATE_PARAMS._replace(force_bias_n=0.0)


def counted(value, channel):
    return encoder_count(value, SCALE[channel], OFFSET[channel], MASK[channel])


@pytest.mark.parametrize("channel", [0, 1, 2, 4])
@pytest.mark.parametrize("count", [0, 1, 500])
def test_a_counter_holds_its_count_over_one_resolution(channel, count):
    def at(part):
        return counted(SCALE[channel] * (count + part) + OFFSET[channel], channel)

    assert at(1e-6) == at(0.999999) == count
    assert at(1.000001) == count + 1


def test_the_counter_of_link_2_runs_backwards():
    assert counted(0.1, 1) < counted(0.0, 1)
    assert counted(0.1, 0) > counted(0.0, 0)


@pytest.mark.parametrize("channel", [0, 1, 2])
def test_a_counter_wraps_at_its_bits(channel):
    def at(count):
        return counted(SCALE[channel] * (count + 0.5) + OFFSET[channel], channel)

    assert at(MASK[channel]) == MASK[channel]
    assert at(MASK[channel] + 1) == 0
    assert at(-1) == MASK[channel]


@given(st.floats(-1.91, 1.91), st.floats(-0.52, 0.47), st.floats(0.0, 1.04))
def test_counts_resolve_every_pose_of_the_travel_to_one_resolution(q1, q2, q3):
    counts = encoder_counts((q1, q2, q3), 0.0)
    for channel, value in enumerate((q1, q2, q3)):
        read = SCALE[channel] * counts[channel] + OFFSET[channel]
        assert abs(read - value) <= abs(SCALE[channel]) * (1 + 1e-9)


def test_roll_is_not_read_and_pitch_stands_straight_down():
    counts = encoder_counts((0.3, 0.1, 0.5), 0.0)
    assert counts[3] == 0
    assert abs(SCALE[4] * counts[4] + OFFSET[4]) <= abs(SCALE[4])


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e300])
def test_what_is_no_number_counts_zero(value):
    assert counted(value, 0) == 0


def test_the_gauge_reads_force_bias_and_noise_floored():
    assert gauge_counts(UNIMATE_PARAMS, 100.0, 5.0) == math.floor(135.0 / N_PER_COUNT)
    assert gauge_counts(QUIET, 7 * N_PER_COUNT * 1.000001, 0.0) == 7
    assert gauge_counts(QUIET, 7 * N_PER_COUNT * 0.999999, 0.0) == 6


def test_the_gauge_saturates_at_both_ends_of_its_range():
    top = math.floor(700.0 / N_PER_COUNT)
    assert gauge_counts(QUIET, 700.0, 0.0) == top == gauge_counts(QUIET, 1e6, 0.0) == gauge_counts(QUIET, math.inf, 0.0)
    assert gauge_counts(QUIET, 700.0 - 2 * N_PER_COUNT, 0.0) < top
    assert gauge_counts(QUIET, 0.0, 0.0) == 0 == gauge_counts(QUIET, 0.0, -10.0)


def test_a_wide_amplifier_still_ends_at_the_converter():
    wide = QUIET._replace(force_low_n=-1e6, force_high_n=1e6)
    assert gauge_counts(wide, 1e5, 0.0) == 2047
    assert gauge_counts(wide, -1e5, 0.0) == -2048


def test_a_force_that_is_no_number_reads_the_lowest_count():
    assert gauge_counts(UNIMATE_PARAMS, math.nan, 0.0) == -2048
