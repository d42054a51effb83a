"""The controller's laws against solutions that are not themselves: python-control, scipy, hand algebra, D-H matrices.

The target impedance and the regression have theirs in their own files.
"""

import math

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hydrohil.services.controller.kinematics import inverse
from hydrohil.services.controller.laws.law import AT_REST
from hydrohil.services.controller.laws.table import law_number, law_step
from hydrohil.services.controller.params import DOWN_UP_GAINS, OUT_IN_GAINS, ROTATE_GAINS
from hydrohil.shared.contract.pose import forward, wrist
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.units import RAD_PER_DEG
from tests.support.link_signals import signals

G = DOWN_UP_GAINS
LAW_PI, LAW_MORSE, LAW_VETIA, LAW_FINAL = map(law_number, ("pi", "morse", "vetia", "final"))
DEG = RAD_PER_DEG
DT_S = 0.0045
LINKS = (ROTATE_GAINS, DOWN_UP_GAINS, OUT_IN_GAINS)


def currents_and_integrals(law, gains, motion, times):
    """(n, 2) current and integral of a law that sees `motion(t)` = (q, q_set, qd, qd_set)."""
    state, found = AT_REST, []
    for t in times:
        q, q_set, qd, qd_set = motion(t)
        state, current, _ = law_step(law, state, gains, signals(q, q_set, qd, qd_set, DT_S))
        found.append((current, state.integral_a))
    return np.array(found)


def lagging(t):
    """3 deg at 0.4 Hz on top of 9 deg/s, and a link that follows half of it, 20 ms late: never slow, often braking."""
    w, size, drift = 2.0 * math.pi * 0.4, 3.0 * DEG, 9.0 * DEG
    q_set, qd_set = size * math.sin(w * t) + drift * t, w * size * math.cos(w * t) + drift
    late = t - 0.020
    return 0.5 * size * math.sin(w * late) + drift * t, q_set, 0.5 * w * size * math.cos(w * late) + drift, qd_set


@pytest.mark.parametrize("gains", LINKS, ids=["rotate", "down/up", "out/in"])
def test_the_linear_law_is_python_controls_discrete_pi(gains):
    """u(z) = (K_P + K_I T z / (z - 1)) e(z)."""
    times = np.arange(800) * DT_S
    errors = np.array([lagging(t)[1] - lagging(t)[0] for t in times])
    law = control.tf([gains.kp_a_per_q], [1.0], DT_S) + control.tf([gains.linear_ki_a_per_q_s * DT_S, 0.0], [1.0, -1.0], DT_S)
    want = np.asarray(control.forced_response(law, times, errors).outputs)
    got = currents_and_integrals(LAW_PI, gains, lagging, times)[:, 0]
    assert got == pytest.approx(want, rel=1e-9, abs=1e-12)


def test_the_linear_law_tends_to_the_continuous_pi():
    times = np.arange(800) * DT_S
    errors = np.array([lagging(t)[1] - lagging(t)[0] for t in times])
    law = control.tf([G.kp_a_per_q, G.linear_ki_a_per_q_s], [1.0, 0.0])
    want = np.asarray(control.forced_response(law, times, errors).outputs)
    got = currents_and_integrals(LAW_PI, G, lagging, times)[:, 0]
    assert got == pytest.approx(want, abs=0.01 * float(np.max(np.abs(want))))


def continuous_integral(gains, motion, times, braking):
    """I' = K_I e + K_a q''_braking - I ln(1 + e'^2 / alpha) / T: the factor a / (a + e'^2) of each period T as a decay."""

    def rate(t, integral):
        q, q_set, qd, qd_set = motion(t)
        ed = qd_set - qd
        alpha = gains.alpha_max_q2_per_s2 * (0.001 + abs(qd_set) / gains.qd_max_q_per_s)
        drive = gains.ki_a_per_q_s * (q_set - q)
        if braking:
            acceleration = (motion(t + 1e-5)[3] - motion(t - 1e-5)[3]) / 2e-5
            drive += gains.ka_a_s_per_q * (acceleration if acceleration * qd_set < 0.0 else 0.0)
        return drive - integral * math.log1p(ed * ed / alpha) / DT_S

    found = solve_ivp(rate, (0.0, times[-1] + DT_S), [0.0], t_eval=times + DT_S, rtol=1e-8, atol=1e-12, max_step=0.005)
    return found.y[0]


@pytest.mark.parametrize(("law", "braking"), [(LAW_MORSE, False), (LAW_FINAL, True)])
def test_the_nonlinear_integral_is_that_of_its_differential_equation(law, braking):
    """Smooth inputs, never stuck: to 2 % of the largest integral, which is what a period of 4.5 ms leaves."""
    times = np.arange(1100) * DT_S
    got = currents_and_integrals(law, G, lagging, times)[:, 1]
    want = continuous_integral(G, lagging, times, braking)
    assert got == pytest.approx(want, abs=0.02 * float(np.max(np.abs(want))))


def test_the_decay_and_the_braking_matter_in_that_comparison():
    times = np.arange(1100) * DT_S
    plain = np.cumsum([G.ki_a_per_q_s * (lagging(t)[1] - lagging(t)[0]) * DT_S for t in times])
    morse, final = (continuous_integral(G, lagging, times, braking) for braking in (False, True))
    assert np.max(np.abs(morse - plain)) > 0.1 * np.max(np.abs(morse))
    assert np.max(np.abs(morse - final)) > 0.1 * np.max(np.abs(morse))


@pytest.mark.parametrize("gains", LINKS, ids=["rotate", "down/up", "out/in"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_boost_sets_the_integral_to_appendix_cs_formula(gains, sign):
    """K_I I = U_boost - K_P e, whatever was in the integral: the next current is U_boost but for one sample of error."""
    e, rate = sign * 2.5 * gains.error_dead_zone_q, sign * 10.0 * gains.stiction_rate_min_q_per_s
    boost_a = gains.boost_positive_a if sign > 0 else -gains.boost_negative_a
    for charge_a in (0.0, 0.01, -0.02):
        state, before, boosted = law_step(
            LAW_VETIA, AT_REST._replace(integral_a=charge_a), gains, signals(0.0, e, 0.0, rate, DT_S)
        )
        assert boosted == 1 and abs(before) < gains.boost_below_a
        assert state.integral_a == pytest.approx(boost_a - gains.kp_a_per_q * e, rel=1e-12)
        _, after, again = law_step(LAW_VETIA, state, gains, signals(0.0, e, 0.0, rate, DT_S))
        alpha = gains.alpha_max_q2_per_s2 * (0.001 + abs(rate) / gains.qd_max_q_per_s)
        charged = (boost_a - gains.kp_a_per_q * e + gains.ki_a_per_q_s * e * DT_S) * alpha / (alpha + rate * rate)
        assert again == 0
        assert after == pytest.approx(gains.kp_a_per_q * e + charged, rel=1e-12)


def denavit_hartenberg(theta, alpha, a, d):
    """One link's homogeneous transform, rotation about z, then about x."""
    ct, st, ca, sa = math.cos(theta), math.sin(theta), math.cos(alpha), math.sin(alpha)
    return np.array([[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0.0, sa, ca, d], [0.0, 0.0, 0.0, 1.0]])


def by_matrices(q, pitch):
    """Tip by Table 1 of the thesis: theta_2 = q2 + 90 deg, and the offset of link 2 negative in its convention."""
    along, across = wrist(UNIMATE.geometry, pitch)
    product = denavit_hartenberg(q[0], -math.pi / 2, 0.0, 0.0)
    product = product @ denavit_hartenberg(q[1] + math.pi / 2, math.pi / 2, -across, 0.0)
    return (product @ denavit_hartenberg(-math.pi / 2, 0.0, 0.0, q[2] + along))[:3, 3]


POSES = [
    ((0.0, 0.0, 0.2), 0.0),
    ((1.2, 0.3, 0.9), -0.4),
    ((-1.7, -0.5, 0.05), -1.2),
    ((0.6, 0.45, 1.0), 0.0),
    ((-0.2, -0.3, 0.5), 0.7),
]


@pytest.mark.parametrize(("q", "pitch"), POSES)
def test_the_tip_is_where_the_product_of_denavit_hartenberg_matrices_puts_it(q, pitch):
    assert forward(UNIMATE.geometry, q, pitch) == pytest.approx(by_matrices(q, pitch), abs=1e-12)


@pytest.mark.parametrize(("q", "pitch"), POSES)
def test_the_inverse_finds_the_joints_that_the_matrices_came_from(q, pitch):
    found, clamped = inverse(UNIMATE.geometry, tuple(by_matrices(q, pitch).tolist()), pitch)
    assert found == pytest.approx(q, abs=1e-9)
    assert clamped == 0
