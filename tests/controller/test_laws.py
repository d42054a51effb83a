import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from hydrohil.services.controller.laws.deadband import deadband_compensation
from hydrohil.services.controller.laws.final import braking_acceleration
from hydrohil.services.controller.laws.hysteresis import relay_sign
from hydrohil.services.controller.laws.law import AT_REST, Law, LinkLawState
from hydrohil.services.controller.laws.parts import morse_factor, peak_speed, position_error, stiction_rate
from hydrohil.services.controller.laws.robust import robust_braking_gain
from hydrohil.services.controller.laws.table import LAW_NAMES, LAWS, fold, law_number, law_step, take_over
from hydrohil.services.controller.laws.torque import load_feedforward
from hydrohil.services.controller.params import A_PER_COUNT, DOWN_UP_GAINS, OUT_IN_GAINS, ROTATE_GAINS, LinkGains
from hydrohil.services.plant.params import UNIMATE_PARAMS
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.units import A_PER_MA, RAD_PER_DEG
from tests.support.link_signals import signals

G = DOWN_UP_GAINS
DEG = RAD_PER_DEG
MA = A_PER_MA
DT_S = 0.0045
SHIPPED = ("pi", "morse", "deadband", "hysteresis", "vetia", "final", "robust", "torque")
LAW_PI, LAW_MORSE, LAW_DEADBAND, LAW_HYSTERESIS, LAW_VETIA, LAW_FINAL, LAW_ROBUST, LAW_TORQUE = map(law_number, SHIPPED)
EVERY_LAW = tuple(range(len(LAWS)))
RTD = 180.0 / math.pi


class Program:
    """`morse_cont` of Appendix F for one link in its own units: deg or m, and counts (2048 = 360 mA)."""

    def __init__(self, minerr, kp, ki, ka, alpha, thresh, deadcomp, down, up, vmax, maxacc, vetia=True, braking=True):
        self.k = (minerr, kp, ki, ka, alpha, thresh, deadcomp, down, up, vmax, maxacc)
        self.vetia, self.braking = vetia, braking
        self.intg, self.flag, self.vo = 0.0, 1, 0.0

    def braking_acceleration(self, qddot, h):
        maxacc = self.k[10]
        acc = (qddot - self.vo) / h
        self.vo = qddot
        if acc > 0.0 and qddot < 0.0:
            return min(acc, maxacc)
        if acc < 0.0 and qddot > 0.0:
            return max(acc, -maxacc)
        return 0.0

    def step(self, q, qd, qdot, qddot, h):
        minerr, kp, ki, ka, alpha, thresh, deadcomp, down, up, vmax, _ = self.k
        err, vel = qd - q, qddot - qdot
        if abs(err) < 2.0 * minerr and abs(qddot) < minerr:
            err = 0.0
        a = alpha * (0.001 + abs(qddot / vmax))
        self.intg += ki / 4.0 * err * h + (ka * self.braking_acceleration(qddot, h) * h if self.braking else 0.0)
        self.intg *= a / (a + vel * vel)
        output = kp * err + self.intg
        nonlin = qddot * qddot
        ub = (qddot - qdot) * nonlin / (nonlin + 50.0 * qdot * qdot + 0.0001)
        if self.vetia and ub > thresh:
            if self.flag and output < deadcomp:
                self.intg += down - output
                self.flag = 0
        elif self.vetia and ub < -thresh:
            if self.flag and output > -deadcomp:
                self.intg += -up - output
                self.flag = 0
        else:
            self.flag = 1
        return output


# the program's numbers per link, K_I of link 2 as the nonlinear law needs it (15e5, the listing holds the linear law's)
IN_PROGRAM_UNITS = (
    (0.03, 3e4 / RTD, 8e5 / RTD, 150.0, 5000.0, 0.15, 450.0, 500.0, 500.0, 10.0, 15.0),
    (0.03, 7e4 / RTD, 15e5 / RTD, 150.0, 8000.0, 0.15, 450.0, 500.0, 650.0, 10.0, 100.0),
    (0.00105, 1e5, 15e5, 20000.0, 20.0, 0.0015, 650.0, 800.0, 1000.0, 0.2, 0.05),
)


def _exact(gains, row, unit):
    """`gains` with the program's counts in place of Table 2's rounded mA."""
    return gains._replace(
        kp_a_per_q=row[1] * A_PER_COUNT / unit,
        ki_a_per_q_s=row[2] / 4.0 * A_PER_COUNT / unit,
        ka_a_s_per_q=row[3] * A_PER_COUNT / unit,
        boost_positive_a=row[7] * A_PER_COUNT,
        boost_negative_a=row[8] * A_PER_COUNT,
    )


@pytest.mark.parametrize("link", [0, 1, 2])
def test_the_final_law_computes_what_the_program_computes_in_its_own_units(link):
    unit = (DEG, DEG, 1.0)[link]
    row = IN_PROGRAM_UNITS[link]
    gains = _exact((ROTATE_GAINS, DOWN_UP_GAINS, OUT_IN_GAINS)[link], row, unit)
    program, state, boosts = Program(*row), AT_REST, 0
    size = (1.0, 1.0, 0.02)[link]
    for i in range(3000):
        t = i * DT_S
        q_set, qd_set = size * math.sin(2.0 * t), 2.0 * size * math.cos(2.0 * t)
        moves = math.sin(5.3 * t) > 0.0  # sticks half of the time
        q, qd = (0.9 * q_set, 0.9 * qd_set) if moves else (0.5 * size, 0.0)
        want = program.step(q, q_set, qd, qd_set, DT_S)
        state, current_a, boosted = law_step(
            LAW_FINAL, state, gains, signals(q * unit, q_set * unit, qd * unit, qd_set * unit, DT_S)
        )
        boosts += boosted
        assert current_a == pytest.approx(want * A_PER_COUNT, rel=1e-9, abs=1e-12)
        assert state.integral_a == pytest.approx(program.intg * A_PER_COUNT, rel=1e-9, abs=1e-12)
        assert state.boost_armed == program.flag
    assert boosts > 5


@pytest.mark.parametrize("law", [LAW_MORSE, LAW_VETIA])
def test_morse_and_vetia_are_the_program_with_the_later_steps_left_out(law):
    row = IN_PROGRAM_UNITS[1]
    gains = _exact(DOWN_UP_GAINS, row, DEG)
    program, state = Program(*row, vetia=law == LAW_VETIA, braking=False), AT_REST
    for i in range(500):
        q_set, qd_set = 0.3 * math.sin(i * 0.02), 1.3 * math.cos(i * 0.02)
        want = program.step(0.1, q_set, 0.01, qd_set, DT_S)
        state, current_a, _ = law_step(law, state, gains, signals(0.1 * DEG, q_set * DEG, 0.01 * DEG, qd_set * DEG, DT_S))
        assert current_a == pytest.approx(want * A_PER_COUNT, rel=1e-9)


def test_table_2_and_the_program_state_the_same_gains():
    for gains, row, unit in zip((ROTATE_GAINS, DOWN_UP_GAINS, OUT_IN_GAINS), IN_PROGRAM_UNITS, (DEG, DEG, 1.0), strict=True):
        exact = _exact(gains, row, unit)
        for table, program in zip(gains, exact, strict=True):
            assert table == pytest.approx(program, rel=0.006)


def test_the_linear_law_is_proportional_plus_integral_with_115_ma_per_deg_s():
    state, u, _ = law_step(LAW_PI, AT_REST, G, signals(0.0, 1.0 * DEG, 0.0, 0.0, 0.1))
    assert u == pytest.approx((215 + 11.5) * MA)
    _, u, _ = law_step(LAW_PI, state, G, signals(0.0, 1.0 * DEG, 0.0, 0.0, 0.1))
    assert u == pytest.approx((215 + 23.0) * MA)


@pytest.mark.parametrize(
    ("error_deg", "speed_deg_per_s", "ignored"), [(0.0599, 0.0299, True), (0.0601, 0.0299, False), (0.0599, 0.0301, False)]
)
def test_small_errors_vanish_only_while_the_set_point_is_slow(error_deg, speed_deg_per_s, ignored):
    for sign in (1.0, -1.0):
        e = position_error(G, signals(0.0, sign * error_deg * DEG, 0.0, sign * speed_deg_per_s * DEG))
        assert (e == 0.0) == ignored


def test_the_dead_zone_does_not_hold_on_its_limit():
    assert position_error(G, signals(0.0, G.error_dead_zone_q, 0.0, 0.0)) == G.error_dead_zone_q


def test_the_morse_factor_is_one_while_following_and_small_after_a_step():
    assert morse_factor(G, 5.0 * DEG, 5.0 * DEG) == 1.0
    assert morse_factor(G, 10.0 * DEG, 0.0) == pytest.approx(8.0 / (8.0 + 100.0))  # alpha = 0.001 * 8000 at rest
    assert morse_factor(G, 0.0, 10.0 * DEG) == pytest.approx(8008.0 / (8008.0 + 100.0))


def test_braking_is_the_set_points_own_deceleration_and_is_clipped():
    assert braking_acceleration(G, 1.0, 0.9, 0.1) == 0.0  # speeding up
    assert braking_acceleration(G, 0.9, 1.0, 0.1) == pytest.approx(-1.0)
    assert braking_acceleration(G, -0.9, -1.0, 0.1) == pytest.approx(1.0)
    assert braking_acceleration(G, 0.1, 1.0, 0.1) == -100 * DEG
    assert braking_acceleration(G, -0.1, -1.0, 0.1) == 100 * DEG
    assert braking_acceleration(G, 0.9, 1.0, 0.0) == 0.0


def test_the_stiction_rate_is_the_velocity_error_of_a_stuck_link_and_zero_for_a_resting_set_point():
    assert stiction_rate(G, 0.0, 1.0 * DEG) == pytest.approx(1.0 * DEG, rel=1e-3)
    assert stiction_rate(G, 1.0 * DEG, 0.0) == 0.0
    assert stiction_rate(G, 1.0 * DEG, 1.1 * DEG) < 0.003 * DEG


def test_the_epsilon_raises_link_3s_trigger_from_1_5_to_5_9_mm_per_s():
    assert stiction_rate(OUT_IN_GAINS, 0.0, 0.0058) < OUT_IN_GAINS.stiction_rate_min_q_per_s
    assert stiction_rate(OUT_IN_GAINS, 0.0, 0.0060) > OUT_IN_GAINS.stiction_rate_min_q_per_s


def _stuck(law, speed_deg_per_s, samples, gains=G):
    state, currents, boosts = AT_REST, [], []
    for i in range(samples):
        q_set = speed_deg_per_s * DEG * i * DT_S
        state, u, boosted = law_step(law, state, gains, signals(0.0, q_set, 0.0, speed_deg_per_s * DEG, DT_S))
        currents.append(u)
        boosts.append(boosted)
    return state, currents, boosts


@pytest.mark.parametrize(("speed", "break_away"), [(0.25, 88 * MA), (-0.25, -114 * MA)])
def test_a_stuck_link_is_boosted_once_and_one_sample_later(speed, break_away):
    _, currents, boosts = _stuck(LAW_VETIA, speed, 20)
    assert boosts == [1] + [0] * 19
    assert abs(currents[0]) < 1 * MA
    assert currents[1] == pytest.approx(break_away, abs=1 * MA)


def test_the_trigger_stands_at_the_threshold_rate():
    # v^3 / (v^2 + 1e-4) = 0.15 deg/s at v = 0.15066 deg/s
    assert sum(_stuck(LAW_VETIA, 0.1506, 20)[2]) == 0
    assert sum(_stuck(LAW_VETIA, 0.1507, 20)[2]) == 1


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("integral_ma", "boosted"), [(79.0, 1), (80.0, 0)])
def test_a_current_above_the_boosts_threshold_is_not_boosted(sign, integral_ma, boosted):
    state = AT_REST._replace(integral_a=sign * integral_ma * MA)
    assert law_step(LAW_VETIA, state, G, signals(0.0, 0.0, 0.0, sign * 1.0 * DEG, DT_S))[2] == boosted


def test_the_boost_is_armed_again_once_the_link_has_moved():
    state, _, _ = _stuck(LAW_VETIA, 0.25, 3)
    assert state.boost_armed == 0
    state, _, _ = law_step(LAW_VETIA, state, G, signals(0.0, 0.0, 0.25 * DEG, 0.25 * DEG, DT_S))
    assert state.boost_armed == 1


def test_deadband_compensation_is_linear_inside_its_width_and_constant_outside():
    for ma, want in ((0.0, 0.0), (3.5, 44.0), (7.0, 88.0), (7.1, 88.0), (300.0, 88.0)):
        assert deadband_compensation(G, ma * MA) == pytest.approx(want * MA)
        assert deadband_compensation(G, -ma * MA) == pytest.approx(-want * MA)


def test_deadband_compensation_adds_to_the_morse_current_and_not_to_its_integral():
    args = (0.0, 0.1 * DEG, 0.0, 0.0, DT_S)
    plain, u, _ = law_step(LAW_MORSE, AT_REST, G, signals(*args))
    for law in (LAW_DEADBAND, LAW_HYSTERESIS):
        state, compensated, _ = law_step(law, AT_REST, G, signals(*args))
        assert compensated == pytest.approx(u + 88 * MA)
        assert state.integral_a == plain.integral_a


def test_the_relay_keeps_its_sign_until_the_current_crosses_the_other_threshold():
    h = G.hysteresis_a
    assert [relay_sign(G, 0, 0.0), relay_sign(G, 0, h), relay_sign(G, 0, 1.001 * h)] == [0, 0, 1]
    assert [relay_sign(G, 1, -h), relay_sign(G, 1, -1.001 * h)] == [1, -1]


def test_a_nan_anywhere_makes_the_current_nan():
    for index in range(4):
        args = [0.1, 0.2, 0.3, 0.4]
        args[index] = math.nan
        assert math.isnan(law_step(LAW_FINAL, AT_REST, G, signals(*args, DT_S))[1])


def test_no_input_leaves_the_domain_and_compiled_agrees_in_every_bit():
    fast = compiled(law_step)
    rng = np.random.default_rng(1)
    edges = [math.nan, math.inf, -math.inf, 0.0, -0.0, 1e308, 1e-320, *(float(v) for v in rng.normal(size=4))]
    for law in EVERY_LAW[:6]:
        plain_state, fast_state = AT_REST, AT_REST
        for _ in range(300):
            args = [float(v) for v in rng.choice(edges[3:], 4)] + [DT_S]
            if rng.random() < 0.3:
                args[int(rng.integers(5))] = float(rng.choice(edges))
            plain, quick = law_step(law, AT_REST, G, signals(*args)), fast(law, AT_REST, G, signals(*args))
            assert repr(plain) == repr(quick)
            plain_state, fast_state = (
                law_step(law, plain_state, G, signals(*args))[0],
                fast(law, fast_state, G, signals(*args))[0],
            )
            assert repr(plain_state) == repr(fast_state)


def test_default_gains_are_link_2():
    assert LinkGains() == DOWN_UP_GAINS


def _brake(law, speed_deg_per_s, samples=40, gains=G):
    """What a link that follows exactly has left in its integral once the set-point has sped up and come to rest."""
    state = AT_REST
    for share in np.sin(np.linspace(0.0, np.pi, 2 * samples + 1))[1:]:
        speed = max(float(share), 1e-9) * speed_deg_per_s * DEG  # at 0 the set-point stands and is not braked
        state, _, boosted = law_step(law, state, gains, signals(0.0, 0.0, speed, speed, DT_S))
        assert boosted == 0
    return state.integral_a


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("speed", [0.1, 0.149, 0.151, 0.5, 2.99, 3.01, 10.0])
def test_a_robust_brake_takes_the_threshold_current_or_what_the_speed_asks_if_that_is_more(speed, sign):
    proportional, least = 26.4 * MA * speed, 450 * A_PER_COUNT
    expected = proportional if speed <= 0.15 else max(proportional, least)
    assert _brake(LAW_ROBUST, sign * speed) == pytest.approx(-sign * expected)
    assert _brake(LAW_FINAL, sign * speed) == pytest.approx(-sign * proportional)


def test_what_a_robust_brake_takes_does_not_depend_on_how_long_it_takes():
    assert _brake(LAW_ROBUST, 0.5, 20) == pytest.approx(_brake(LAW_ROBUST, 0.5, 200))


def test_a_large_motion_is_braked_by_the_robust_law_as_by_the_final_law_in_every_bit():
    one, other = AT_REST, AT_REST
    for i in range(2000):
        t = i * DT_S
        q_set, qd_set = 1.0 * math.sin(6.0 * t) * DEG, 6.0 * math.cos(6.0 * t) * DEG
        args = (0.9 * q_set, q_set, 0.8 * qd_set, qd_set, DT_S)
        one, u, _ = law_step(LAW_ROBUST, one, G, signals(*args))
        other, expected, _ = law_step(LAW_FINAL, other, G, signals(*args))
        assert u == expected


def test_a_set_point_that_noise_moves_is_braked_as_by_the_final_law():
    rng, one, other = np.random.default_rng(3), AT_REST, AT_REST
    for speed in rng.uniform(-0.15, 0.15, 2000) * DEG:
        one = law_step(LAW_ROBUST, one, G, signals(0.0, 0.0, 0.0, float(speed), DT_S))[0]
        other = law_step(LAW_FINAL, other, G, signals(0.0, 0.0, 0.0, float(speed), DT_S))[0]
    assert one.integral_a == other.integral_a != 0.0


def test_the_robust_law_is_the_solution_of_its_differential_equation():
    # I' = K_I e + max(K_a, U_b / v) q_s'' while braking - I ln(1 + e'^2 / a) / dt,  on a sine followed to nine tenths
    amplitude, omega, dt_s = 0.3 * DEG, 2.0 * np.pi, 0.5e-3
    peak = amplitude * omega
    gain = max(26.4 * MA / DEG, 450 * A_PER_COUNT / peak)

    def rate(t, integral):
        q_set, qd_set = amplitude * np.sin(omega * t), peak * np.cos(omega * t)
        acceleration = -omega * omega * q_set
        braking = acceleration if acceleration * qd_set < 0.0 else 0.0
        alpha = 8000 * DEG * DEG * (0.001 + abs(qd_set) / (10 * DEG))
        return 1151 * MA / DEG * 0.1 * q_set + gain * braking - integral * np.log(1.0 + (0.1 * qd_set) ** 2 / alpha) / dt_s

    gains = G._replace(error_dead_zone_q=0.0)
    state, times = LinkLawState(peak_q_per_s=peak, qd_set=peak), np.arange(1, 4001) * dt_s
    integrals_a = []
    for t in times:
        q_set, qd_set = amplitude * math.sin(omega * t), peak * math.cos(omega * t)
        state, _, boosted = law_step(LAW_ROBUST, state, gains, signals(0.9 * q_set, q_set, 0.9 * qd_set, qd_set, dt_s))
        assert boosted == 0
        integrals_a.append(state.integral_a)
    exact = solve_ivp(rate, (0.0, times[-1]), [0.0], t_eval=times, max_step=2e-3, rtol=1e-8, atol=1e-12).y[0]
    assert np.ptp(exact) > 50 * MA
    assert np.array(integrals_a) == pytest.approx(exact, abs=0.01 * np.ptp(exact))


def test_a_motion_is_as_fast_as_its_fastest_moment_until_the_set_point_stands_or_turns_round():
    state, peaks = AT_REST, []
    for speed in (0.1, 0.3, 0.2, 0.05, 0.2, 0.0, 0.1, -0.05, -0.02):
        peak = peak_speed(state, speed)
        state = state._replace(peak_q_per_s=peak, qd_set=speed)
        peaks.append(peak)
    assert peaks == [0.1, 0.3, 0.3, 0.3, 0.3, 0.0, 0.1, 0.05, 0.05]


def test_braking_stays_finite_however_slow_the_motion_was():
    gains = G._replace(stiction_rate_min_q_per_s=0.0)
    assert robust_braking_gain(gains, 0.0) == gains.ka_a_s_per_q
    assert robust_braking_gain(G, 1e-320) == G.ka_a_s_per_q


def test_only_the_torque_law_feeds_the_load_forward_and_against_it():
    assert load_feedforward(G, 200.0) == pytest.approx(-13.6 * MA)
    assert load_feedforward(G, -200.0) == pytest.approx(13.6 * MA)
    for law in EVERY_LAW:
        free, loaded = (law_step(law, AT_REST, G, signals(0.0, 0.01, 0.0, 0.1, load_tau=tau))[1] for tau in (0.0, 200.0))
        assert loaded - free == pytest.approx(-13.6 * MA if law == LAW_TORQUE else 0.0)


@pytest.mark.parametrize(
    ("gains", "link", "load"),
    [
        (ROTATE_GAINS, UNIMATE_PARAMS.rotate, 250.0),
        (G, UNIMATE_PARAMS.down_up, 250.0),
        (OUT_IN_GAINS, UNIMATE_PARAMS.out_in, 500.0),
    ],
)
def test_the_feed_forward_is_what_a_load_takes_off_the_break_away_current(gains, link, load):
    # a stuck link: the ports feed what leaks at D P = F_s - load,  K_q a(u)^2 sqrt((P_s - P) / 2) = C_l P + C_n P
    def break_away_a(load):
        pressure = (link.breakaway_tau - load) / link.displacement_m3_per_q
        leak = (link.cross_leak_m3_per_s_pa + link.null_leak_m3_per_s_pa) * pressure
        full = link.flow_gain_m3_per_s_sqrt_pa * math.sqrt((UNIMATE_PARAMS.supply_pressure_pa - pressure) / 2.0)
        share = brentq(lambda part: full * part * part - leak, 0.0, 1.0)
        return link.overlap_a + share * (link.full_scale_a - link.overlap_a)

    slope = (break_away_a(-load) - break_away_a(load)) / (2.0 * load)
    assert gains.load_feedforward_a_per_tau == pytest.approx(slope, rel=0.1)


def test_the_later_laws_agree_in_every_bit_compiled_and_never_leave_the_domain():
    fast, rng = compiled(law_step), np.random.default_rng(2)
    edges = [math.nan, math.inf, -math.inf, 0.0, -0.0, 1e308, 1e-320, *(float(v) for v in rng.normal(size=6) * 0.02)]
    for law in EVERY_LAW[6:]:
        plain_state, fast_state = AT_REST, AT_REST
        for _ in range(300):
            args = [float(v) for v in rng.choice(edges[3:], 4)] + [DT_S]
            if rng.random() < 0.3:
                args[int(rng.integers(5))] = float(rng.choice(edges))
            assert repr(law_step(law, AT_REST, G, signals(*args))) == repr(fast(law, AT_REST, G, signals(*args)))
            plain_state, fast_state = (
                law_step(law, plain_state, G, signals(*args))[0],
                fast(law, fast_state, G, signals(*args))[0],
            )
            assert repr(plain_state) == repr(fast_state)


OLD = LinkLawState(0.3, 0, 0.1, -1, 0.2)  # of whatever law there was before


@pytest.mark.parametrize("law", EVERY_LAW)
@pytest.mark.parametrize("held_a", [-0.2, -0.105, -0.1, -0.09, -0.05, -0.005, 0.0, 0.005, 0.05, 0.09, 0.1, 0.2])
@pytest.mark.parametrize("error", [-0.02, 0.0, 0.003])
def test_a_law_that_takes_over_gives_the_current_that_the_valve_has(law, held_a, error):
    read = signals(0.1, 0.1 + error, 0.0, 0.0, dt_s=0.0, load_tau=40.0, held_a=held_a)  # at rest no law resets or boosts
    state = take_over(law, OLD, G, read)
    after, current_a, boosted = law_step(law, state, G, read)
    if law == LAW_HYSTERESIS and G.hysteresis_a < abs(held_a) < G.deadband_positive_a - G.hysteresis_a:
        assert current_a == pytest.approx(math.copysign(G.deadband_positive_a, held_a))  # the relay leaps over it: its own level
    else:
        assert current_a == pytest.approx(held_a, abs=1e-12)
    assert after.integral_a == pytest.approx(state.integral_a) and boosted == 0


def test_other_gains_keep_the_sum_of_proportional_and_integral_term():
    stiffer = G._replace(kp_a_per_q=2.0 * G.kp_a_per_q)
    e, before = 0.01, LinkLawState(0.03)
    held_a = G.kp_a_per_q * e + before.integral_a
    after = take_over(LAW_PI, before, stiffer, signals(0.0, e, 0.0, 0.0, held_a=held_a))
    assert after.integral_a == pytest.approx(before.integral_a + (G.kp_a_per_q - stiffer.kp_a_per_q) * e)


def test_inside_the_dead_zone_the_integral_takes_all_of_the_current():
    e = 0.99 * G.error_dead_zone_q
    assert take_over(LAW_FINAL, OLD, G, signals(0.0, e, 0.0, 0.0, held_a=0.04)).integral_a == 0.04


def test_what_a_law_remembers_of_the_motion_is_handed_on():
    after = take_over(LAW_FINAL, OLD, G, signals(0.0, 0.01, 0.0, 0.15, held_a=0.04))
    assert (after.boost_armed, after.qd_set, after.peak_q_per_s) == (OLD.boost_armed, 0.15, OLD.peak_q_per_s)


def test_compiled_and_plain_take_over_to_the_same_bits():
    fast = compiled(take_over)
    for law in EVERY_LAW:
        for held_a in (-0.2, -0.03, 0.0, 0.05, 0.36):
            arguments = (law, OLD, G, signals(0.1, 0.12, 0.0, 0.05, load_tau=30.0, held_a=held_a))
            assert tuple(fast(*arguments)) == tuple(take_over(*arguments))


def test_a_law_is_found_by_its_name_and_no_two_have_one():
    assert LAW_NAMES[: len(SHIPPED)] == SHIPPED  # a law keeps its number: a new one is added at the end
    assert len(set(LAW_NAMES)) == len(LAWS)
    assert [law_number(name) for name in LAW_NAMES] == list(EVERY_LAW)


def test_a_number_that_no_row_has_gives_no_current():
    state, current_a, boosted = law_step(len(LAWS), OLD, G, signals(0.0, 0.01, 0.0, 0.0))
    assert math.isnan(current_a) and (state, boosted) == (OLD, 0)
    assert math.isnan(take_over(len(LAWS), OLD, G, signals(0.0, 0.01, 0.0, 0.0)).integral_a)


def test_a_row_more_is_a_law_more():
    double = Law("double", lambda state, gains, signals: (state, 2.0 * (signals.q_set - signals.q), 0))
    step, part = fold((*LAWS, double))
    read = signals(0.0, 0.25, 0.0, 0.0)
    assert step(len(LAWS), OLD, G, read) == (OLD, 0.5, 0)
    assert part(len(LAWS), OLD, G, read, 0.1) == (0.1, OLD.relay)
    assert step(LAW_PI, OLD, G, read) == law_step(LAW_PI, OLD, G, read)
