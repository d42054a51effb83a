import math

import numpy as np
import pytest

from hydrohil.services.controller.regression import POINTS, filled_window, push, velocities
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.units import RAD_PER_DEG

PERIOD_NS = 4_500_000
COUNT_RAD = 0.0284006 * RAD_PER_DEG


def _follow(position, times_ns, demanded=lambda t: (0.0, 0.0, 0.0)):
    window = filled_window(times_ns[0] - PERIOD_NS, position(0.0), PERIOD_NS)
    out = []
    for time_ns in times_ns:
        window = push(window, time_ns, position(time_ns * 1e-9), demanded(time_ns * 1e-9))
        out.append(velocities(window))
    return out


def test_a_link_that_stands_has_no_velocity_at_all():
    window = filled_window(0, (0.1, -0.3, 0.777), PERIOD_NS)
    assert velocities(window) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert velocities(push(window, PERIOD_NS, (0.1, -0.3, 0.777), (0.1, -0.3, 0.777))) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def test_the_filled_window_ends_at_its_time_and_steps_back_by_the_period():
    times = [point.time_ns for point in filled_window(10**9, (0.0, 0.0, 0.0), PERIOD_NS)]
    assert times == [10**9 - (POINTS - 1 - i) * PERIOD_NS for i in range(POINTS)]


def test_jittered_samples_of_a_ramp_give_its_slope_exactly():
    rng = np.random.default_rng(3)
    times = [int(t) for t in 10**10 + np.cumsum(rng.integers(4_000_000, 5_000_001, 60))]
    speed, demanded_speed = (0.2, -1.5, 0.03), (1.0, -0.5, 0.25)
    out = _follow(lambda t: tuple(v * t for v in speed), times, lambda t: tuple(v * t for v in demanded_speed))
    for measured, demanded in out[POINTS:]:
        assert measured == pytest.approx(speed, rel=1e-9)
        assert demanded == pytest.approx(demanded_speed, rel=1e-9)


def test_it_is_the_least_squares_slope():
    rng = np.random.default_rng(5)
    window = filled_window(0, (0.0, 0.0, 0.0), PERIOD_NS)
    times, q = np.cumsum(rng.integers(4_000_000, 5_000_001, POINTS)), rng.normal(size=(POINTS, 3))
    for time_ns, row in zip(times, q, strict=True):
        window = push(window, int(time_ns), tuple(row), tuple(2.0 * row))
    slopes = np.polyfit(times * 1e-9, q, 1)[0]
    measured, demanded = velocities(window)
    assert measured == pytest.approx(slopes, rel=1e-9)
    assert demanded == pytest.approx(2.0 * slopes, rel=1e-9)


def test_it_lags_an_acceleration_by_half_the_window():
    times = [i * PERIOD_NS for i in range(100)]
    out = _follow(lambda t: (0.5 * t * t, 0.0, 0.0), times)
    lag_s = times[-1] * 1e-9 - out[-1][0][0]  # the velocity of t^2/2 is t
    assert lag_s == pytest.approx((POINTS - 1) * PERIOD_NS * 1e-9 / 2, rel=1e-6)


def test_one_encoder_count_makes_no_spike():
    # a two-point slope would show count / T; over 20 points a step at the middle shows at most 1.5 count / (20 T)
    times = [i * PERIOD_NS for i in range(80)]
    out = _follow(lambda t: (COUNT_RAD * (t > 0.2), 0.0, 0.0), times)
    peak = max(measured[0] for measured, _ in out)
    assert peak == pytest.approx(1.5 * COUNT_RAD / (POINTS * PERIOD_NS * 1e-9), rel=0.01)


def test_samples_of_one_instant_give_zero_instead_of_a_division():
    assert velocities(filled_window(0, (1.0, 2.0, 3.0), 0)) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def test_plain_and_compiled_agree_in_every_bit_for_edges_too():
    slopes = compiled(velocities)
    rng = np.random.default_rng(7)
    window = filled_window(0, (0.0, 0.0, 0.0), PERIOD_NS)
    for i in range(60):
        q = tuple(float(v) for v in rng.normal(size=3))
        if i > 40:
            q = (math.nan, math.inf, -1e308)
        window = push(window, i * PERIOD_NS + int(rng.integers(500_000)), q, q[::-1])
        assert repr(velocities(window)) == repr(slopes(window))
