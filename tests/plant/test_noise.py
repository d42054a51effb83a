import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.services.plant.noise import FORCE_CHANNEL, JITTER_CHANNEL, force_noise_n, sample_intervals
from hydrohil.shared.draws import uniforms


@given(st.integers(0, 2**64 - 1), st.integers(-(2**31), 2**31), st.integers(0, 40), st.integers(0, 40))
def test_a_window_equals_the_same_window_of_a_longer_one(seed, first, skipped, count):
    whole_noise = force_noise_n(seed, first, skipped + count, 5.0, 10.0)
    whole_intervals = sample_intervals(seed, first, skipped + count, 90, 10)
    assert np.array_equal(whole_noise[skipped:], force_noise_n(seed, first + skipped, count, 5.0, 10.0))
    assert np.array_equal(whole_intervals[skipped:], sample_intervals(seed, first + skipped, count, 90, 10))


def test_noise_is_gaussian_of_its_sigma_and_clipped():
    wide = force_noise_n(1, -1000, 200_000, 5.0, 1e9)
    assert wide.mean() == pytest.approx(0.0, abs=0.05)
    assert wide.std() == pytest.approx(5.0, rel=0.01)
    assert np.mean(np.abs(wide) < 5.0) == pytest.approx(0.6827, abs=0.005)
    assert np.array_equal(force_noise_n(1, -1000, 200_000, 5.0, 10.0), np.clip(wide, -10.0, 10.0))
    assert abs(np.corrcoef(wide[1:], wide[:-1])[0, 1]) < 0.01


def test_seeds_and_channels_are_independent():
    one, other = force_noise_n(1, 0, 50_000, 5.0, 10.0), force_noise_n(2, 0, 50_000, 5.0, 10.0)
    assert abs(np.corrcoef(one, other)[0, 1]) < 0.02
    force, jitter = uniforms(1, FORCE_CHANNEL, 0, 50_000)[:, 0], uniforms(1, JITTER_CHANNEL, 0, 50_000)[:, 0]
    assert abs(np.corrcoef(force, jitter)[0, 1]) < 0.02


def test_intervals_are_whole_and_even_over_period_plus_minus_jitter():
    intervals = sample_intervals(3, 0, 210_000, 90, 10)
    values, times = np.unique(intervals, return_counts=True)
    assert intervals.dtype == np.int64
    assert values.tolist() == list(range(80, 101))
    assert times == pytest.approx(10_000, rel=0.05)


def test_no_jitter_is_the_bare_period_and_no_sigma_is_silence():
    assert set(sample_intervals(3, -5, 100, 90, 0).tolist()) == {90}
    assert not force_noise_n(3, -5, 100, 0.0, 10.0).any()
    assert force_noise_n(3, 0, 0, 5.0, 10.0).shape == (0,)
