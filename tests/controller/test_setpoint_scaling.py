import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hydrohil.services.controller.config import ImpedanceConfig, impedance_params, setpoint_scaling_params
from hydrohil.services.controller.impedance import impedance_step, rest
from hydrohil.services.controller.params import SetpointScalingParams
from hydrohil.services.controller.setpoint_scaling import Offset, offset_step
from hydrohil.shared.compiled.kernel import compiled

DT_S = 0.0045
ZERO = (0.0, 0.0, 0.0)
SOFT, STIFF, K_EFF = 1500.0, 20e3, 6231.0
CONFIG = ImpedanceConfig(500.0, STIFF, 1.2, "net", K_EFF, apparent_stiffness_n_per_m=SOFT, contact_n=0.0)


def pressed(config, depth_m, ramp_s=2.0, end_s=12.0):
    """Set-point depth and force of an ideal tool on a spring k_eff, whose nominal position goes `depth_m` below the surface."""
    target, apparent = impedance_params(config, 2, 1.0), setpoint_scaling_params(config)
    state, offset, force_n, depths = rest(ZERO, ZERO), Offset(0.0, ZERO), 1e-9, []
    for tick in range(round(end_s / DT_S)):
        nominal = (0.0, 0.0, -depth_m * min(1.0, tick * DT_S / ramp_s))
        offset = offset_step(offset, apparent, 2, nominal, force_n)
        compensated = (nominal[0], nominal[1], nominal[2] - offset.offset_m)
        state, x = impedance_step(state, target, compensated, force_n, DT_S)
        force_n = config.environment_n_per_m * max(1e-12, -x[2])
        depths.append(-x[2])
    return np.array(depths), force_n


@pytest.mark.parametrize("soft", [50.0, 500.0, 1500.0, 5e3])
@pytest.mark.parametrize("depth_m", [0.01, 0.06])
def test_the_steady_force_is_that_of_the_apparent_stiffness(soft, depth_m):
    _, force_n = pressed(CONFIG._replace(apparent_stiffness_n_per_m=soft), depth_m)
    assert force_n == pytest.approx(soft * K_EFF / (soft + K_EFF) * depth_m, rel=1e-3)
    _, bare_n = pressed(CONFIG._replace(apparent_stiffness_n_per_m=None), depth_m)
    assert bare_n == pytest.approx(STIFF * K_EFF / (STIFF + K_EFF) * depth_m, rel=1e-3)


def test_the_way_there_is_that_of_the_stiff_target_under_the_smaller_ramp():
    depth_m, ramp_s = 0.06, 2.0
    share = SOFT * (STIFF + K_EFF) / (STIFF * (SOFT + K_EFF))
    m, c = 500.0, 2.0 * 1.2 * math.sqrt(500.0 * (STIFF + K_EFF))

    def slope(t, state):
        nominal, rate = share * depth_m * min(1.0, t / ramp_s), share * depth_m / ramp_s * (t < ramp_s)
        x, v = state
        return v, (c * (rate - v) + STIFF * (nominal - x) - K_EFF * x) / m

    depths, _ = pressed(CONFIG, depth_m, ramp_s, 6.0)
    run = solve_ivp(slope, (0.0, 6.0), (0.0, 0.0), rtol=1e-9, atol=1e-12, max_step=0.01, dense_output=True)
    expected = run.sol(np.arange(1, len(depths) + 1) * DT_S)[0]
    assert depths == pytest.approx(expected, abs=0.01 * share * depth_m)  # the loop sees its force one sample late


def test_without_contact_and_without_an_apparent_stiffness_there_is_no_offset():
    path = [(0.0, 0.0, -0.001 * n) for n in range(50)]
    for params, force_n in ((setpoint_scaling_params(CONFIG), 0.0), (setpoint_scaling_params(ImpedanceConfig()), 300.0)):
        state = Offset(0.0, ZERO)
        for nominal in path:
            state = offset_step(state, params, 2, nominal, force_n)
        assert state == Offset(0.0, path[-1])


def test_contact_is_confirmed_above_its_threshold_and_not_on_it():
    params = SetpointScalingParams(0.25, 10.0)
    assert offset_step(Offset(0.0, ZERO), params, 2, (0.0, 0.0, -0.04), 10.0).offset_m == 0.0
    above = math.nextafter(10.0, 11.0)
    assert offset_step(Offset(0.0, ZERO), params, 2, (0.0, 0.0, -0.04), above).offset_m == pytest.approx(-0.03)
    assert offset_step(Offset(0.0, ZERO), params, 2, (0.0, 0.0, -0.04), math.nan).offset_m == 0.0


@pytest.mark.parametrize("axis", [0, 2])
def test_only_steps_along_the_gauge_are_compensated(axis):
    params, step = SetpointScalingParams(0.25, 10.0), [0.01, 0.02, 0.04]
    assert offset_step(Offset(0.0, ZERO), params, axis, tuple(step), 50.0).offset_m == pytest.approx(0.75 * step[axis])


def test_the_offset_of_the_way_in_is_given_back_on_the_way_out():
    params, state = SetpointScalingParams(0.25, 10.0), Offset(0.0, ZERO)
    for z_m in (*np.linspace(0.0, -0.06, 40), *np.linspace(-0.06, 0.0, 25)):
        state = offset_step(state, params, 2, (0.0, 0.0, float(z_m)), 50.0)
    assert state.offset_m == pytest.approx(0.0, abs=1e-15)


def test_an_apparent_stiffness_near_that_of_the_target_takes_off_next_to_nothing():
    assert setpoint_scaling_params(CONFIG._replace(apparent_stiffness_n_per_m=STIFF)).share == 1.0
    assert setpoint_scaling_params(CONFIG).share == pytest.approx(1500.0 * 26231.0 / (20e3 * 7731.0))


def test_compiled_agrees_in_every_bit():
    fast = compiled(offset_step)
    for value in (math.nan, math.inf, -math.inf, 0.0, -1.0, 10.0, 11.0, 1e308):
        for share in (1.0, 0.25):
            arguments = (Offset(0.001, (0.1, 0.2, 0.3)), SetpointScalingParams(share, 10.0), 2, (0.1, value, 0.7), value)
            assert repr(offset_step(*arguments)) == repr(fast(*arguments))
