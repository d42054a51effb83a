import math

import numpy as np
import pytest
from scipy.signal import lsim

from hydrohil.services.controller.config import ImpedanceConfig, impedance_params
from hydrohil.services.controller.explicit import FILTERS_AT_REST, explicit_step
from hydrohil.services.controller.impedance import impedance_step, rest
from hydrohil.services.controller.laws.law import AT_REST
from hydrohil.services.controller.laws.table import law_number, law_step
from hydrohil.services.controller.params import UNIMATE_GAINS
from hydrohil.shared.compiled.kernel import compiled
from tests.support.link_signals import signals

DT_S = 0.0045
MASS_KG, K_EFF = 500.0, 6200.0
ZERO = (0.0, 0.0, 0.0)
LAW_PI = law_number("pi")
NO_DEAD_ZONE = UNIMATE_GAINS[1]._replace(error_dead_zone_q=0.0)


def _params(k, xi_net=3.0, axis=2, sign=1.0):
    return impedance_params(ImpedanceConfig(MASS_KG, k, xi_net, "net", K_EFF), axis, sign)


def _damping(k, xi_net=3.0):
    return 2.0 * xi_net * math.sqrt((k + K_EFF) * MASS_KG)


def _run(params, force_n, force_set_n, dt_s=DT_S):
    """Way in m that the force error asks for, at the end of each interval over which both forces are held."""
    state, ways = FILTERS_AT_REST, []
    for f, fd in zip(force_n, force_set_n, strict=True):
        state, way_m = explicit_step(state, params, f, fd, dt_s)
        ways.append(way_m)
    return np.array(ways)


def _held(numerator, denominator, inputs, dt_s=DT_S):
    """Output of a transfer function at the end of each interval, its input held over the interval."""
    times = np.arange(len(inputs) + 1) * dt_s
    return lsim((numerator, denominator), np.append(inputs, inputs[-1]), times, interp=False)[1][1:]


@pytest.mark.parametrize("xi_net", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("k", [50.0, 500.0, 5000.0, 50e3])
def test_both_filters_are_the_transfer_functions_of_the_thesis(k, xi_net):
    rng = np.random.default_rng(3)
    force, set_point_n, c = rng.normal(size=800) * 50.0, rng.normal(size=800) * 100.0, _damping(k, xi_net)
    error = force - _held([K_EFF], [MASS_KG, c, k + K_EFF], set_point_n)
    want = error / K_EFF + _held([1.0], [MASS_KG, c, k], error)
    assert _run(_params(k, xi_net), force, set_point_n) == pytest.approx(want, abs=1e-12)


def _program(force_error_n, k):
    """`mod_c` of Appendix F: the filter's feed-through by differentiating its own output twice."""
    c, dt, offset, momentum, out = _damping(k), DT_S, 0.0, 0.0, []
    for x in _held([1.0], [MASS_KG, c, k], force_error_n):
        first = MASS_KG * (x - offset) / dt
        second = (c * (x - offset) + first - momentum) / dt
        offset, momentum = x, first
        out.append((second + (k + K_EFF) * x) / K_EFF)
    return np.array(out)


@pytest.mark.parametrize("k", [50.0, 500.0, 5000.0])
def test_it_agrees_with_the_programs_filter_as_far_as_that_ones_differences_go(k):
    force = 30.0 * np.sin(2.0 * np.arange(2000) * DT_S)
    assert _run(_params(k), force, np.zeros(2000)) == pytest.approx(_program(force, k), abs=0.03 * 30.0 / K_EFF)


def test_law_and_filter_may_change_places():
    # the program lets the law act on the force error and filters its answer
    force = np.random.default_rng(4).normal(size=500) * 20.0
    first = _law(_run(_params(500.0), force, np.zeros(500)))
    then = _run(_params(500.0), _law(force), np.zeros(500))
    assert first == pytest.approx(then, rel=1e-9)


def _law(errors):
    state, out = AT_REST, []
    for error in errors:
        state, current_a, _ = law_step(LAW_PI, state, NO_DEAD_ZONE, signals(0.0, error, 0.0, 0.0, DT_S))
        out.append(current_a)
    return np.array(out)


@pytest.mark.parametrize("k", [50.0, 500.0, 5000.0])
def test_in_the_steady_state_model_and_environment_share_the_force_set_point(k):
    # thesis 6.3: 99, 92 and 55 N of 100 N; at that force no way remains
    shared_n = 100.0 * K_EFF / (k + K_EFF)
    assert shared_n == pytest.approx({50.0: 99.0, 500.0: 92.0, 5000.0: 55.0}[k], abs=0.6)
    way_m = _run(_params(k), np.full(8000, shared_n), np.full(8000, 100.0), dt_s=0.5)[-1]
    assert way_m == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("axis", "sign"), [(2, 1.0), (0, -1.0)])
def test_too_little_force_asks_for_a_way_against_the_push(axis, sign):
    way_m = _run(_params(500.0, axis=axis, sign=sign), np.zeros(400), np.full(400, 100.0))[-1]
    assert way_m * sign < 0.0


def _impedance_controlled(params, dt_s, seconds):
    """Force in N of a link with a linear valve that presses a spring k_eff, set-point by the target impedance."""
    x, state, law, force = 0.0, rest(ZERO, ZERO), AT_REST, []
    for _ in range(round(seconds / dt_s)):
        f = -K_EFF * x
        state, x_set = impedance_step(state, params, ZERO, f - 100.0, dt_s)
        law, current_a, _ = law_step(LAW_PI, law, NO_DEAD_ZONE, signals(x, x_set[2], 0.0, 0.0, dt_s))
        x += 0.5 * current_a * dt_s
        force.append(f)
    return np.array(force)


def _explicitly_controlled(params, dt_s, seconds):
    """The same link under the equivalent explicit force controller."""
    x, state, law, force = 0.0, FILTERS_AT_REST, AT_REST, []
    for _ in range(round(seconds / dt_s)):
        f = -K_EFF * x
        state, way_m = explicit_step(state, params, f, 100.0, dt_s)
        law, current_a, _ = law_step(LAW_PI, law, NO_DEAD_ZONE, signals(0.0, way_m, 0.0, 0.0, dt_s))
        x += 0.5 * current_a * dt_s
        force.append(f)
    return np.array(force)


@pytest.mark.parametrize("k", [50.0, 500.0, 5000.0])
def test_on_a_linear_machine_the_equivalent_controller_makes_the_same_motion(k):
    params, apart_n = _params(k), []
    for dt_s in (DT_S, DT_S / 4.0):
        one, other = _impedance_controlled(params, dt_s, 8.0), _explicitly_controlled(params, dt_s, 8.0)
        apart_n.append(np.max(np.abs(one - other)))
        assert one[-1] == pytest.approx(100.0 * K_EFF / (k + K_EFF), rel=0.02)
    assert apart_n[0] < 0.3
    assert apart_n[1] < 0.3 * apart_n[0]  # what is left is the sampling


def test_no_input_leaves_the_domain_and_compiled_agrees_in_every_bit():
    fast, edges = compiled(explicit_step), (math.nan, math.inf, -math.inf, 0.0, -1.0, 1e-320, 1e308, 1.0)
    for value in edges:
        for changed in ("stiffness_n_per_m", "environment_n_per_m", "natural_frequency_rad_per_s", "damping_ratio"):
            params = _params(500.0)._replace(**{changed: value})
            plain = explicit_step(FILTERS_AT_REST, params, 10.0, 20.0, DT_S)
            assert repr(plain) == repr(fast(FILTERS_AT_REST, params, 10.0, 20.0, DT_S))
        for arguments in ((value, 20.0, DT_S), (10.0, value, DT_S), (10.0, 20.0, value)):
            plain = explicit_step(FILTERS_AT_REST, _params(500.0), *arguments)
            assert repr(plain) == repr(fast(FILTERS_AT_REST, _params(500.0), *arguments))


@pytest.mark.parametrize("k_eff", [0.0, -1.0, math.nan, math.inf])
def test_without_an_environment_there_is_no_answer(k_eff):
    assert math.isnan(explicit_step(FILTERS_AT_REST, _params(500.0)._replace(environment_n_per_m=k_eff), 1.0, 2.0, DT_S)[1])
