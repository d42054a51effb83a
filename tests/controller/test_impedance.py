import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lsim

from hydrohil.services.controller.impedance import decay, impedance_step, mean_of_three, rest
from hydrohil.services.controller.params import ImpedanceParams
from hydrohil.shared.compiled.kernel import compiled

DT_S = 0.0045
MASS_KG, STIFFNESS = 500.0, 50e3
WN = math.sqrt(STIFFNESS / MASS_KG)
NEAR_CRITICAL = [1.0 + sign * 10.0**-power for power in (4, 6, 8, 10, 14) for sign in (-1, 1)]
DAMPINGS = [0.0, 0.3, 0.9, 1.0, 1.2, 3.0, 30.0, *NEAR_CRITICAL]
ZERO = (0.0, 0.0, 0.0)


def _params(xi, axis=2, sign=1.0, stiffness=STIFFNESS, wn=WN):
    return ImpedanceParams(stiffness, wn, xi, 1.0, axis, sign)


def _run(params, nominal, force, dt_s=DT_S):
    """Set-points x_s at the end of each interval, for inputs held over that interval."""
    state, out = rest(ZERO, ZERO), [ZERO]
    for x, f in zip(nominal, force, strict=True):
        state, x_set = impedance_step(state, params, (x, -2.0 * x, 3.0 * x), f, dt_s)
        out.append(x_set)
    return np.array(out)


def _expected(numerator, denominator, inputs):
    times = np.arange(len(inputs) + 1) * DT_S
    return lsim((numerator, denominator), np.append(inputs, inputs[-1]), times, interp=False)[1]


@pytest.mark.parametrize("xi", DAMPINGS)
def test_the_position_response_is_that_of_the_differential_equation(xi):
    nominal = np.random.default_rng(1).normal(size=600) * 0.01
    got = _run(_params(xi), nominal, np.zeros(600))
    c = 2.0 * xi * WN
    want = _expected(np.trim_zeros([c, WN * WN], "f"), [1.0, c, WN * WN], nominal)
    assert got == pytest.approx(np.outer(want, [1.0, -2.0, 3.0]), abs=2e-12)


@pytest.mark.parametrize("xi", DAMPINGS)
def test_the_force_response_is_that_of_the_differential_equation(xi):
    force = np.random.default_rng(2).normal(size=600) * 100.0
    got = _run(_params(xi), np.zeros(600), force)[:, 2]
    want = _expected([1.0 / MASS_KG], [1.0, 2.0 * xi * WN, WN * WN], force)
    assert got == pytest.approx(want, abs=1e-12)


@pytest.mark.parametrize("xi", [0.3, 1.0, 1.0 + 1e-9, 3.0])
def test_a_ramp_and_a_force_together_agree_with_a_numerical_integration(xi):
    # the held input is a staircase, so the integration kicks the velocity by c/m dx at each stair
    params, c = _params(xi, axis=0, sign=-1.0), 2.0 * xi * WN
    nominal = 0.02 * np.sin(np.arange(120) * DT_S * 3.0)
    force = np.full(120, 80.0)
    x, v, last = 0.0, 0.0, 0.0
    for target in nominal:
        v += c * (target - last)
        run = solve_ivp(
            lambda _, s, target=target: (s[1], -c * s[1] - WN * WN * (s[0] - target) - 80.0 / MASS_KG),
            (0.0, DT_S),
            (x, v),
            rtol=1e-11,
            atol=1e-14,
        )
        (x, v), last = run.y[:, -1], target
    assert _run(params, nominal, force)[-1][0] == pytest.approx(x, abs=1e-9)


@pytest.mark.parametrize("xi", [0.3, 1.0, 3.0])
def test_a_force_ends_at_the_deflection_of_the_spring(xi):
    # thesis 5.2: 100 N on 500 N/m is 0.2 m
    params = _params(xi, stiffness=500.0, wn=2.0)
    got = _run(params, np.zeros(20_000), np.full(20_000, 100.0))
    assert got[-1][2] == pytest.approx(0.2, abs=1e-9)


def test_the_underdamped_model_of_the_thesis_swings_with_a_period_of_3_3_s():
    got = _run(_params(0.3, stiffness=500.0, wn=2.0), np.zeros(2000), np.full(2000, 100.0))[:, 2]
    crossings = np.nonzero(np.diff(np.sign(got - 0.2)))[0]
    assert 2.0 * np.mean(np.diff(crossings[:4])) * DT_S == pytest.approx(3.3, abs=0.02)


def test_a_step_of_the_nominal_position_kicks_the_velocity_by_c_over_m():
    xi, step = 0.5, 0.1
    state, _ = impedance_step(rest(ZERO, ZERO), _params(xi), (0.0, 0.0, step), 0.0, 0.0)
    assert state.velocity_m_per_s[2] == pytest.approx(2.0 * xi * WN * step)
    assert state.position_m[2] == 0.0


@pytest.mark.parametrize(("axis", "sign"), [(2, 1.0), (0, -1.0)])
def test_it_yields_to_the_environment_and_presses_against_it_for_a_force_set_point(axis, sign):
    params = _params(1.0, axis=axis, sign=sign)
    for f_minus_fd, direction in ((50.0, sign), (-50.0, -sign)):
        got = _run(params, np.zeros(400), np.full(400, f_minus_fd))[-1]
        assert got[axis] == pytest.approx(direction * 50.0 / STIFFNESS, rel=1e-3)
        assert all(got[other] == 0.0 for other in range(3) if other != axis)


@pytest.mark.parametrize("xi", DAMPINGS)
def test_a_model_at_rest_stays_exactly_where_it_is(xi):
    x = (0.91, -0.2, -0.37)
    state, x_set = impedance_step(rest(x, x), _params(xi), x, 0.0, DT_S)
    assert x_set == x
    assert state.velocity_m_per_s == ZERO


@pytest.mark.parametrize("xi", [0.3, 1.0, 3.0])
def test_two_half_intervals_make_a_whole_one(xi):
    params, whole, halves = _params(xi), rest(ZERO, ZERO), rest(ZERO, ZERO)
    for _ in range(50):
        whole, _ = impedance_step(whole, params, (0.01, 0.0, 0.0), 30.0, 2.0 * DT_S)
        halves, _ = impedance_step(halves, params, (0.01, 0.0, 0.0), 30.0, DT_S)
        halves, _ = impedance_step(halves, params, (0.01, 0.0, 0.0), 30.0, DT_S)
    assert halves.position_m == pytest.approx(whole.position_m, abs=1e-14)
    assert halves.force_offset_m == pytest.approx(whole.force_offset_m, abs=1e-15)


def test_a_long_gap_settles_a_heavily_damped_model_without_overflow():
    free = decay(1000.0, 100.0, 60.0)
    assert free.c == pytest.approx(0.0, abs=1e-100)
    assert free.s == pytest.approx(0.0, abs=1e-100)


def test_the_gauge_is_averaged_over_three_samples():
    assert mean_of_three(3.0, 6.0, 9.0) == 6.0


def test_no_input_leaves_the_domain_and_compiled_agrees_in_every_bit():
    fast, fast_step = compiled(decay), compiled(impedance_step)
    edges = (math.nan, math.inf, -math.inf, 0.0, -1.0, 1e-320, 1e308, 1.0, 1.0 + 1e-9, 0.3)
    for wn in edges:
        for xi in edges:
            for dt_s in (*edges, DT_S):
                assert repr(decay(wn, xi, dt_s)) == repr(fast(wn, xi, dt_s))
    state = rest(ZERO, ZERO)
    for xi in DAMPINGS:
        for value in edges:
            plain = impedance_step(state, _params(xi), (value, 0.1, 0.2), value, DT_S)
            assert repr(plain) == repr(fast_step(state, _params(xi), (value, 0.1, 0.2), value, DT_S))
