import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hydrohil.services.controller.adaptation import LEAST_SHARE, adapted_step, braked, force_excess, softened, stiffness_loss_step
from hydrohil.services.controller.impedance import impedance_step, rest
from hydrohil.services.controller.params import (
    ADAPT_LIMIT_SWITCH,
    ADAPT_NONE,
    ADAPT_OFFSET,
    ADAPT_STIFFNESS,
    AdaptationParams,
    ImpedanceParams,
)
from hydrohil.shared.compiled.kernel import compiled

DT_S = 0.0045
MASS, K, XI = 50.0, 1e3, 5.0
C = 2.0 * XI * math.sqrt(MASS * K)
TARGET = ImpedanceParams(K, math.sqrt(K / MASS), XI, 1.0, 2, 1.0)
ZERO = (0.0, 0.0, 0.0)
KINDS = (ADAPT_STIFFNESS, ADAPT_OFFSET, ADAPT_LIMIT_SWITCH)


def adaptation(kind, onset_n=20.0, ceiling_n=100.0, softening=20.0, retreat=0.2, stop_n=100.0, stop_ns_per_m=1e3, release_s=2.0):
    return AdaptationParams(
        kind=kind,
        onset_n=onset_n,
        ceiling_n=ceiling_n,
        softening_per_s=softening,
        retreat_m_per_s=retreat,
        stop_n=stop_n,
        stop_ns_per_m=stop_ns_per_m,
        release_s=release_s,
    )


def run(kind, forces, nominal=None, params=TARGET, dts=None, **changed):
    state, settings, out, stiffness_loss = rest(ZERO, ZERO), adaptation(kind, **changed), [], []
    nominal = np.zeros((len(forces), 3)) if nominal is None else nominal
    for n, force in enumerate(forces):
        dt_s = DT_S if dts is None else float(dts[n])
        state, x_set = adapted_step(
            state,
            params,
            adaptation=settings,
            nominal_m=tuple(nominal[n].tolist()),
            force_n=float(force),
            force_error_n=float(force),
            dt_s=dt_s,
        )
        out.append(x_set)
        stiffness_loss.append(state.stiffness_loss)
    return np.array(out), np.array(stiffness_loss), state


def push(count=400, seed=1):
    return 60.0 + 50.0 * np.sin(np.arange(count) * DT_S * 9.0) + np.random.default_rng(seed).normal(size=count) * 5.0


def path(count=400):
    z_m = -0.06 * np.sin(np.arange(count) * DT_S * 0.4)
    return np.column_stack((0.5 * z_m, np.zeros(count), z_m))


def test_the_excess_is_zero_on_the_onset_and_one_on_the_ceiling():
    settings = adaptation(ADAPT_OFFSET)
    assert [force_excess(settings, f) for f in (-5.0, 20.0, 60.0, 100.0, 140.0)] == [0.0, 0.0, 0.5, 1.0, 1.5]
    assert math.isnan(force_excess(settings, math.nan))


def test_without_adaptation_it_is_the_step_of_the_target_alone():
    state, other = rest(ZERO, ZERO), rest(ZERO, ZERO)
    for force in push():
        state, x_set = adapted_step(
            state,
            TARGET,
            adaptation=adaptation(ADAPT_NONE),
            nominal_m=(0.01, 0.0, 0.02),
            force_n=float(force),
            force_error_n=float(force),
            dt_s=DT_S,
        )
        other, expected = impedance_step(other, TARGET, (0.01, 0.0, 0.02), float(force), DT_S)
        assert (x_set, state) == (expected, other)


@pytest.mark.parametrize("kind", KINDS)
def test_a_force_up_to_the_onset_changes_nothing(kind):
    forces = np.full(100, 20.0)
    got, stiffness_loss, _ = run(kind, forces, path(100))
    plain, _, _ = run(ADAPT_NONE, forces, path(100))
    assert np.array_equal(got, plain)
    assert not stiffness_loss.any()


@pytest.mark.parametrize("kind", KINDS)
def test_a_force_just_past_the_onset_gives_way_along_the_gauge_and_nowhere_else(kind):
    forces = np.full(200, 22.0)
    got, _, _ = run(kind, forces, path(200))
    plain, _, _ = run(ADAPT_NONE, forces, path(200))
    assert got[-1, 2] > plain[-1, 2]
    assert np.array_equal(got[:, :2], plain[:, :2])


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("kind", KINDS)
def test_it_gives_way_in_the_direction_of_the_push(kind, sign):
    params = TARGET._replace(force_axis=0, force_sign=sign)
    got, _, _ = run(kind, np.full(200, 90.0), params=params)
    plain, _, _ = run(ADAPT_NONE, np.full(200, 90.0), params=params)
    assert (got[-1, 0] - plain[-1, 0]) * sign > 0.001


def test_softening_keeps_mass_and_damping_ratio_so_that_the_damper_softens_too():
    soft = softened(TARGET, 0.75)
    assert soft.stiffness_n_per_m == pytest.approx(0.25 * K)
    assert soft.stiffness_n_per_m / soft.natural_frequency_rad_per_s**2 == pytest.approx(MASS)
    assert soft.damping_ratio == XI
    assert 2.0 * soft.damping_ratio * soft.natural_frequency_rad_per_s * MASS == pytest.approx(C / 2.0)


def test_a_brake_keeps_mass_and_stiffness():
    slow = braked(TARGET, 300.0)
    assert (slow.stiffness_n_per_m, slow.natural_frequency_rad_per_s) == (K, TARGET.natural_frequency_rad_per_s)
    assert 2.0 * slow.damping_ratio * math.sqrt(MASS * K) == pytest.approx(C + 300.0)


def test_the_spring_softens_as_its_rate_says_and_hardens_with_its_time_constant():
    def change(_, share):
        return -20.0 * 0.5 * share  # excess 0.5 at 60 N

    _, stiffness_loss, _ = run(ADAPT_STIFFNESS, np.full(40, 60.0))
    want = solve_ivp(change, (0.0, 40 * DT_S), (1.0,), rtol=1e-10, atol=1e-12).y[0, -1]
    assert 1.0 - stiffness_loss[-1] == pytest.approx(want, rel=1e-7)
    _, back, _ = run(ADAPT_STIFFNESS, np.concatenate((np.full(40, 60.0), np.zeros(444))))
    assert back[-1] == pytest.approx(stiffness_loss[-1] * math.exp(-444 * DT_S / 2.0))


def test_a_spring_never_softens_to_nothing():
    _, stiffness_loss, _ = run(ADAPT_STIFFNESS, np.full(4000, 500.0))
    assert stiffness_loss[-1] == 1.0 - LEAST_SHARE


def test_the_offset_grows_with_the_retreat_speed_at_the_ceiling_and_fades():
    _, stiffness_loss, _ = run(ADAPT_OFFSET, np.concatenate((np.full(100, 100.0), np.zeros(444))))
    assert stiffness_loss[99] == pytest.approx(0.2 * 100 * DT_S)
    assert stiffness_loss[-1] == pytest.approx(stiffness_loss[99] * math.exp(-444 * DT_S / 2.0))


def test_the_stop_pushes_with_its_force_at_the_ceiling_and_leaves_no_trace():
    got, stiffness_loss, _ = run(ADAPT_LIMIT_SWITCH, np.full(20_000, 100.0))
    assert got[-1, 2] == pytest.approx((100.0 + 100.0) / K)
    assert not stiffness_loss.any()


def test_a_softening_target_follows_its_differential_equation():
    # m x'' + c(t) (x' - xd') + k(t) (x - xd) = f with the k of each sample, c = 2 xi sqrt(m k); the staircase xd kicks by c/m dx
    forces, nominal = push(), path()
    dts = np.random.default_rng(3).uniform(0.004, 0.005, len(forces))
    got, stiffness_loss, _ = run(ADAPT_STIFFNESS, forces, nominal, dts=dts)
    x, v, last = 0.0, 0.0, 0.0
    for force, target, gone, dt_s in zip(forces, nominal[:, 2], stiffness_loss, dts, strict=True):
        c = C * math.sqrt(1.0 - gone)
        v += c / MASS * (target - last)

        def change(_, s, force=force, target=target, gone=gone, c=c):
            return (s[1], (force - c * s[1] - (1.0 - gone) * K * (s[0] - target)) / MASS)

        (x, v), last = solve_ivp(change, (0.0, dt_s), (x, v), rtol=1e-11, atol=1e-14).y[:, -1], target
    assert stiffness_loss.max() == 1.0 - LEAST_SHARE
    assert got[-1, 2] == pytest.approx(x, abs=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_target_against_the_stop_follows_its_differential_equation(sign):
    # m x'' + c (x' - xd') + d x' + k (x - xd) = sign (f + stop excess), d only while engaged; xd kicks by c/m dx, never by d/m dx
    forces, nominal = push() - 35.0, path()
    got, _, _ = run(ADAPT_LIMIT_SWITCH, forces, nominal, params=TARGET._replace(force_sign=sign), stop_n=400.0, stop_ns_per_m=3e3)
    x, v, last = 0.0, 0.0, 0.0
    for force, target in zip(forces, nominal[:, 2], strict=True):
        v += C / MASS * (target - last)
        damping, pushed = (C + 3e3, force + 5.0 * (force - 20.0)) if force > 20.0 else (C, force)

        def change(_, s, pushed=pushed, target=target, damping=damping):
            return (s[1], (sign * pushed - damping * s[1] - K * (s[0] - target)) / MASS)

        (x, v), last = solve_ivp(change, (0.0, DT_S), (x, v), rtol=1e-11, atol=1e-14).y[:, -1], target
    assert 0.2 < np.mean(forces > 20.0) < 0.8
    assert got[-1, 2] == pytest.approx(x, abs=1e-9)


def test_the_damper_of_the_stop_only_takes_energy():
    # the nominal position stands: kinetic and spring energy grow by no more than the work of force and stop
    settings, state, work, before = adaptation(ADAPT_LIMIT_SWITCH, stop_ns_per_m=2e3), rest(ZERO, ZERO), 0.0, 0.0
    for force in push():
        state, _ = adapted_step(
            state, TARGET, adaptation=settings, nominal_m=ZERO, force_n=float(force), force_error_n=float(force), dt_s=DT_S
        )
        x, v = state.force_offset_m, state.force_velocity_m_per_s
        work += (force + 100.0 * force_excess(settings, float(force))) * (x - before)
        assert 0.5 * MASS * v * v + 0.5 * K * x * x <= work + 1e-9
        before = x


def test_behind_a_stop_of_endless_damping_the_model_stands_wherever_the_nominal_position_goes():
    got, _, _ = run(ADAPT_LIMIT_SWITCH, np.full(200, 60.0), path(200), stop_ns_per_m=1e9)
    assert np.ptp(got[:, 2]) < 1e-6
    assert np.ptp(got[:, 0]) > 1e-3


def test_an_adapting_stiffness_feeds_no_energy_into_a_model_that_only_gives_way():
    # while k only falls, m v^2 / 2 + k x^2 / 2 grows by no more than the work of the force
    settings, state, work, before = adaptation(ADAPT_STIFFNESS), rest(ZERO, ZERO), 0.0, 0.0
    for force in np.abs(push()) + 21.0:
        state, _ = adapted_step(
            state, TARGET, adaptation=settings, nominal_m=ZERO, force_n=float(force), force_error_n=float(force), dt_s=DT_S
        )
        x, v = state.force_offset_m, state.force_velocity_m_per_s
        work += force * (x - before)
        energy = 0.5 * MASS * v * v + 0.5 * K * (1.0 - state.stiffness_loss) * x * x
        assert energy <= work + 1e-9
        before = x


def test_position_and_velocity_are_continuous_where_the_stiffness_jumps():
    _, _, state = run(ADAPT_STIFFNESS, push())
    for force in (20.0, 400.0):
        new, _ = adapted_step(
            state,
            TARGET,
            adaptation=adaptation(ADAPT_STIFFNESS),
            nominal_m=state.nominal_m,
            force_n=force,
            force_error_n=force,
            dt_s=1e-9,
        )
        assert new.force_offset_m == pytest.approx(state.force_offset_m, abs=1e-8)
        assert new.force_velocity_m_per_s == pytest.approx(state.force_velocity_m_per_s, abs=1e-7)


@pytest.mark.parametrize("kind", KINDS)
def test_against_a_spring_the_steady_force_falls_below_that_of_the_target_alone(kind):
    # the tool is where the model says, the surface yields as 25 kN/m: the target alone presses with k k_eff / (k + k_eff) depth
    def steady(kind):
        state, force, stiff, peak = rest(ZERO, ZERO), 0.0, TARGET._replace(damping_ratio=XI), 0.0
        for n in range(4000):
            nominal = (0.0, 0.0, -0.06 * min(1.0, n / 1000.0))
            state, x_set = adapted_step(
                state, stiff, adaptation=adaptation(kind), nominal_m=nominal, force_n=force, force_error_n=force, dt_s=DT_S
            )
            force = max(0.0, -25e3 * x_set[2])
            peak = max(peak, force)
        return force, peak

    alone, peak_alone = steady(ADAPT_NONE)
    assert alone == pytest.approx(1e3 * 25e3 / 26e3 * 0.06, rel=0.01)
    force, peak = steady(kind)
    assert force < alone
    assert peak < peak_alone


def test_no_input_leaves_the_domain_and_compiled_agrees_in_every_bit():
    fast, fast_stiffness_loss = compiled(adapted_step), compiled(stiffness_loss_step)
    _, _, state = run(ADAPT_STIFFNESS, push(50))
    for kind in (ADAPT_NONE, *KINDS):
        settings = adaptation(kind)
        for value in (math.nan, math.inf, -math.inf, 0.0, 20.0, 1e-320, 1e308, 77.7):
            for dt_s in (DT_S, 0.0, -1.0, math.nan):
                assert repr(stiffness_loss_step(0.25, settings, value, dt_s)) == repr(
                    fast_stiffness_loss(0.25, settings, value, dt_s)
                )
                plain = adapted_step(
                    state, TARGET, adaptation=settings, nominal_m=(0.1, 0.2, 0.3), force_n=value, force_error_n=value, dt_s=dt_s
                )
                assert repr(plain) == repr(
                    fast(
                        state,
                        TARGET,
                        adaptation=settings,
                        nominal_m=(0.1, 0.2, 0.3),
                        force_n=value,
                        force_error_n=value,
                        dt_s=dt_s,
                    )
                )
