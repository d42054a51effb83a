import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hydrohil.services.controller.alternate import measured_step
from hydrohil.services.controller.config import ImpedanceConfig, impedance_params
from hydrohil.services.controller.impedance import rest
from hydrohil.shared.compiled.kernel import compiled

DT_S = 0.0045
MASS_KG, K_EFF = 5000.0, 6200.0
ZERO = (0.0, 0.0, 0.0)


def _params(k=500.0, xi_net=1.0, axis=2, sign=1.0):
    return impedance_params(ImpedanceConfig(MASS_KG, k, xi_net, "net", K_EFF, formulation="measured"), axis, sign)


def _damping(k, xi_net=1.0):
    return 2.0 * xi_net * math.sqrt((k + K_EFF) * MASS_KG)


@pytest.mark.parametrize(("axis", "sign"), [(0, -1.0), (1, 1.0), (2, 1.0)])
def test_the_set_point_is_that_of_the_differential_equation_for_inputs_held_over_each_interval(axis, sign):
    rng, k = np.random.default_rng(5), 500.0
    params, c = _params(k, axis=axis, sign=sign), _damping(k)
    nominal, x, v = rng.normal(size=(120, 3)) * 0.01, rng.normal(size=(120, 3)) * 0.02, rng.normal(size=(120, 3)) * 0.1
    force = rng.normal(size=120) * 100.0
    state, expected, rate = rest(ZERO, ZERO), np.zeros(3), np.zeros(3)
    for i in range(120):
        state, x_set = measured_step(
            state, params, nominal_m=tuple(nominal[i]), x_m=tuple(x[i]), v=tuple(v[i]), force_error_n=force[i], dt_s=DT_S
        )
        rate = rate + c / MASS_KG * (nominal[i] - (nominal[i - 1] if i else 0.0))  # what c x_d' is at a step
        push = sign * force[i] * (np.arange(3) == axis)
        a = (push - c * v[i] - k * (x[i] - nominal[i])) / MASS_KG
        run = solve_ivp(lambda _, s, a=a: np.concatenate((s[3:], a)), (0.0, DT_S), np.concatenate((expected, rate)), rtol=1e-11)
        expected, rate = run.y[:3, -1], run.y[3:, -1]
    assert x_set == pytest.approx(expected, abs=1e-10)
    assert state.velocity_m_per_s == pytest.approx(rate, abs=1e-10)


@pytest.mark.parametrize("k", [50.0, 500.0, 5000.0, 50e3])
def test_a_tool_that_follows_at_once_moves_and_presses_as_by_the_first_formulation(k):
    # x = x_s on a spring: (m s^2 + c s + k + k_eff) x = f_d, thesis 6.2.2 "the same expressions for F_d"
    params, state, x, force = _params(k), rest(ZERO, ZERO), ZERO, []
    for _ in range(4000):
        force.append(-K_EFF * x[2])
        state, x = measured_step(
            state, params, nominal_m=ZERO, x_m=x, v=state.velocity_m_per_s, force_error_n=force[-1] - 100.0, dt_s=DT_S
        )
    c = _damping(k)
    run = solve_ivp(
        lambda _, s: (s[1], (100.0 - c * s[1] - (k + K_EFF) * s[0]) / MASS_KG),
        (0.0, 18.0),
        (0.0, 0.0),
        t_eval=np.arange(4000) * DT_S,
        rtol=1e-9,
        atol=1e-12,
    )
    assert np.array(force) == pytest.approx(K_EFF * run.y[0], abs=2.0)
    assert force[-1] == pytest.approx(100.0 * K_EFF / (k + K_EFF), abs=0.01)


def test_a_force_error_that_remains_moves_the_set_point_without_end():
    # the filter has no finite steady state (thesis 6.2.2): twice the time is four times the way
    params, state, way_m = _params(), rest(ZERO, ZERO), []
    for _ in range(1000):
        state, x_set = measured_step(state, params, nominal_m=ZERO, x_m=ZERO, v=ZERO, force_error_n=-100.0, dt_s=DT_S)
        way_m.append(x_set[2])
    assert way_m[999] == pytest.approx(4.0 * way_m[499])
    assert way_m[999] == pytest.approx(-0.5 * 100.0 / MASS_KG * (1000 * DT_S) ** 2)


def test_a_tool_at_its_nominal_position_stays_exactly_there():
    x = (0.91, -0.2, -0.37)
    state, x_set = measured_step(rest(x, x), _params(), nominal_m=x, x_m=x, v=ZERO, force_error_n=0.0, dt_s=DT_S)
    assert x_set == x
    assert state.velocity_m_per_s == ZERO


def test_no_input_leaves_the_domain_and_compiled_agrees_in_every_bit():
    fast = compiled(measured_step)
    for value in (math.nan, math.inf, -math.inf, 0.0, -1.0, 1e-320, 1e308):
        for arguments in (
            ((value, 0.1, 0.2), ZERO, ZERO, 1.0, DT_S),
            (ZERO, (value, 0.1, 0.2), ZERO, 1.0, DT_S),
            (ZERO, ZERO, (value, 0.1, 0.2), 1.0, DT_S),
            (ZERO, ZERO, ZERO, value, DT_S),
            (ZERO, ZERO, ZERO, 1.0, value),
        ):
            plain = measured_step(rest(ZERO, ZERO), _params(), *arguments)
            assert repr(plain) == repr(fast(rest(ZERO, ZERO), _params(), *arguments))
