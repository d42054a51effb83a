import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.claims.study import Curve
from hydrohil.pages.curves import MOST_POINTS, thinned


@given(st.integers(0, 2**32 - 1), st.integers(1, 30_000))
def test_a_thinned_signal_keeps_its_extremes_and_its_ends(seed, count):
    x = np.arange(count, dtype=float)
    y = np.random.default_rng(seed).normal(size=count)
    kept = thinned(Curve("noise", x, y))
    assert len(kept.x) <= MOST_POINTS + 2
    assert (kept.y.min(), kept.y.max(), kept.x[0], kept.x[-1]) == (y.min(), y.max(), x[0], x[-1])
    assert np.all(np.diff(kept.x) > 0.0)


def test_a_path_keeps_its_extremes_both_ways():
    angle = np.linspace(0.0, 20.0, 40_000)
    x, y = np.cos(angle) * angle, np.sin(angle) * angle
    kept = thinned(Curve("spiral", x, y))
    assert len(kept.x) <= MOST_POINTS + 2
    assert (kept.x.min(), kept.x.max(), kept.y.min(), kept.y.max()) == (x.min(), x.max(), y.min(), y.max())


def test_a_single_spike_between_thousands_of_samples_stays():
    y = np.zeros(20_000)
    y[12_345] = 1.0
    assert thinned(Curve("spike", np.arange(20_000.0), y)).y.max() == 1.0


def test_a_short_curve_is_left_as_it_is():
    curve = Curve("short", np.arange(MOST_POINTS * 1.0), np.zeros(MOST_POINTS))
    assert thinned(curve) is curve
