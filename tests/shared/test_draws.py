import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.shared.draws import SPACING, uniforms


@given(st.integers(0, 2**64 - 1), st.integers(0, 2**16), st.integers(-(2**31), 2**31), st.integers(0, 40), st.integers(0, 40))
def test_a_window_equals_the_same_window_of_a_longer_one(seed, channel, first, skipped, count):
    whole = uniforms(seed, channel, first, skipped + count)
    assert np.array_equal(whole[skipped:], uniforms(seed, channel, first + skipped, count))
    assert whole.shape == (skipped + count, 4)


def test_numbers_are_uniform_and_never_zero():
    drawn = uniforms(1, 1, -1000, 50_000)
    assert drawn.min() >= SPACING and drawn.max() <= 1.0
    assert drawn.mean() == pytest.approx(0.5, abs=0.005)
    assert np.histogram(drawn, bins=10, range=(0.0, 1.0))[0] == pytest.approx(20_000, rel=0.05)


def test_seeds_channels_and_the_four_numbers_of_a_tick_are_independent():
    one, other = uniforms(1, 1, 0, 50_000), uniforms(2, 1, 0, 50_000)
    channel = uniforms(1, 2, 0, 50_000)
    for first, second in ((one[:, 0], other[:, 0]), (one[:, 0], channel[:, 0]), (one[:, 0], one[:, 1])):
        assert abs(np.corrcoef(first, second)[0, 1]) < 0.02


def test_the_numbers_are_the_same_on_every_machine_and_in_every_version():
    assert uniforms(7, 1, -2, 2)[:, 0].tolist() == [0.23449087731224505, 0.3359576321234585]
