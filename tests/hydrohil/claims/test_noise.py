import math

import numpy as np
import pytest

from hydrohil.claims.metrics import rms_deviation, setpoint_noise
from tests.hydrohil.claims.test_trace import link, standing


def test_white_noise_on_a_set_point_is_measured_whole():
    trace = standing(20.0)
    noise = np.random.default_rng(1).normal(size=len(trace.t_s)) * 1e-4
    assert setpoint_noise(trace._replace(x_set_m=link(noise, 3)), "z") == pytest.approx(1e-4, rel=0.03)


def test_what_the_reference_does_and_what_is_slow_is_no_noise():
    trace = standing(20.0)
    path, drift = 0.06 * np.sin(0.4 * trace.t_s), 0.01 * trace.t_s
    assert setpoint_noise(trace._replace(x_set_m=link(path, 3), x_nominal_m=link(path, 3)), "z") == 0.0
    assert setpoint_noise(trace._replace(x_set_m=link(drift, 3)), "z") == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("hz", "share"), [(0.2, 0.02), (10.0, 1.0)])
def test_a_slow_swing_hardly_counts_and_a_fast_one_does(hz, share):
    trace = standing(40.0)
    swing = math.sqrt(2.0) * 1e-3 * np.sin(2.0 * np.pi * hz * trace.t_s)
    assert setpoint_noise(trace._replace(x_set_m=link(swing, 3)), "z") == pytest.approx(share * 1e-3, abs=1e-4)


@pytest.mark.parametrize("duration_s", [0.0, 0.4])
def test_a_window_shorter_than_half_a_second_determines_no_noise(duration_s):
    assert math.isnan(setpoint_noise(standing(duration_s), "z"))


def test_the_distance_from_the_nominal_trajectory_is_squared_and_averaged():
    trace = standing(1.0)
    trace = trace._replace(
        x_m=link(np.where(trace.tick % 2 == 0, 3e-3, -3e-3), 3), x_nominal_m=link(np.full(len(trace.t_s), 4e-3), 3)
    )
    assert rms_deviation(trace, "z") == pytest.approx(5e-3, rel=1e-2)
    assert rms_deviation(trace, "x") == 0.0
