import numpy as np
import pytest

from hydrohil.claims.signals import rms
from hydrohil.thesis.velocity import (
    COUNTS,
    OWN_RESOLUTION_DEG,
    PERIOD_S,
    RESOLUTION_DEG,
    digitised_deg,
    distortion,
    lag_s,
    noise_deg_per_s,
    position_deg,
    profile_times_s,
    regressed_deg_per_s,
)


@pytest.mark.parametrize("points", COUNTS)
def test_every_regression_is_the_line_that_polyfit_draws(points):
    times = profile_times_s()
    readings = digitised_deg(position_deg(times), RESOLUTION_DEG)
    slopes = regressed_deg_per_s(points, RESOLUTION_DEG)
    for last in range(points - 1, len(times), 7):
        shown = slice(last - points + 1, last + 1)
        assert slopes[last] == pytest.approx(np.polyfit(times[shown], readings[shown], 1)[0], abs=1e-8)


@pytest.mark.parametrize("points", COUNTS)
def test_the_lag_is_half_the_window(points):
    assert lag_s(points) == pytest.approx((points - 1) * PERIOD_S / 2.0, rel=1e-6)


def test_more_points_are_quieter_and_more_distorted():
    noises = [rms(noise_deg_per_s(points, RESOLUTION_DEG)) for points in COUNTS]
    assert noises == sorted(noises, reverse=True)
    distortions = [distortion(points) for points in COUNTS]
    assert distortions == sorted(distortions)


def test_a_regression_is_linear_in_the_resolution():
    coarse, fine = (rms(noise_deg_per_s(20, resolution)) for resolution in (RESOLUTION_DEG, OWN_RESOLUTION_DEG))
    assert coarse / fine == pytest.approx(RESOLUTION_DEG / OWN_RESOLUTION_DEG, rel=0.2)


def test_at_the_robots_own_resolution_ten_points_are_as_smooth_as_the_text_has_twenty():
    assert rms(noise_deg_per_s(10, OWN_RESOLUTION_DEG)) < rms(noise_deg_per_s(20, RESOLUTION_DEG))
