"""The plant's sub-steps against the documented differential equations, integrated by scipy."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.signal import lsim

from hydrohil.services.plant.contact import contact_start, contact_step
from hydrohil.services.plant.hydraulics import LinkState
from hydrohil.services.plant.machine import link_step
from hydrohil.services.plant.mechanism import inertias, motion_loads, posture
from hydrohil.services.plant.params import UNIMATE_PARAMS, Environment, contact_params
from hydrohil.shared.compiled.kernel import compiled

STEP_S = 50e-6
LINKS = (UNIMATE_PARAMS.rotate, UNIMATE_PARAMS.down_up, UNIMATE_PARAMS.out_in)
NAMES = ["rotate", "down/up", "out/in"]
INERTIA = (361.0, 111.0, 45.0)
HUGE_NM = 1e12  # friction that locks a link


def many_steps(state, link, machine, currents, load_tau, inertia, step_s):
    found = np.empty((len(currents), 5))
    for row in range(len(currents)):
        state = link_step(
            state=state,
            link=link,
            machine=machine,
            current_a=currents[row],
            load_tau=load_tau,
            inertia_tau_s2_per_q=inertia,
            step_s=step_s,
        )
        found[row, 0] = state.q
        found[row, 1] = state.qd
        found[row, 2] = state.spool_a
        found[row, 3] = state.pressure_a_pa
        found[row, 4] = state.pressure_b_pa
    return found


RUN = compiled(many_steps)


def derivatives(link, current_at, load_tau, inertia, locked):
    """State (q, q', spool, Pa, Pb): valve, orifice, continuity and Newton as docs/explanation/physics.md writes them."""
    supply, drain = UNIMATE_PARAMS.supply_pressure_pa, UNIMATE_PARAMS.return_pressure_pa
    d = link.displacement_m3_per_q

    def root(drop):
        return (
            math.copysign(math.sqrt(abs(drop)), drop)
            * (drop * drop / (drop * drop + UNIMATE_PARAMS.root_smoothing_pa**2)) ** 0.25
        )

    def rate(t, state):
        q, v, x, a, b = state
        opening = max(0.0, abs(x) - link.overlap_a) / (link.full_scale_a - link.overlap_a)
        gain = link.flow_gain_m3_per_s_sqrt_pa * opening**2
        if x > 0.0:
            into_a, into_b = gain * root(supply - a), -gain * root(b - drain)
        else:
            into_a, into_b = -gain * root(a - drain), gain * root(supply - b)
        cross, null = link.cross_leak_m3_per_s_pa * (a - b), link.null_leak_m3_per_s_pa
        volume_a = link.dead_volume_m3 + d * (q - link.travel_low_q)
        volume_b = link.dead_volume_m3 + d * (link.travel_high_q - q)
        speed = 0.0 if locked else v
        return (
            speed,
            0.0 if locked else (d * (a - b) - link.viscous_tau_s_per_q * v + load_tau) / inertia,
            (current_at(t) + link.null_bias_a - x) / link.valve_lag_s,
            link.bulk_modulus_pa / volume_a * (into_a - cross + null * (supply - 2.0 * a + drain) - d * speed),
            link.bulk_modulus_pa / volume_b * (into_b + cross + null * (supply - 2.0 * b + drain) + d * speed),
        )

    return rate


@pytest.mark.parametrize("locked", [True, False], ids=["locked", "free"])
@pytest.mark.parametrize("index", [0, 1, 2], ids=NAMES)
def test_one_link_moves_as_its_differential_equations(index, locked):
    """A current that swings through both ports and the overlap, for 0.8 s; dry friction locks the link or is left out."""
    friction = HUGE_NM if locked else 0.0
    link = LINKS[index]._replace(coulomb_tau=friction, breakaway_tau=friction)
    middle = (link.travel_low_q + link.travel_high_q) / 2.0 + 0.05
    load_tau, inertia = (0.0, 60.0, -100.0)[index], INERTIA[index]

    def current_at(t):
        return 0.25 * math.sin(2.0 * math.pi * 2.0 * t)

    times = np.arange(1, round(0.8 / STEP_S) + 1) * STEP_S
    start = LinkState(middle, 0.0, 0.0, 3.4e6, 3.6e6)
    currents = np.array([current_at(t - STEP_S / 2.0) for t in times])
    got = RUN(
        state=start, link=link, machine=UNIMATE_PARAMS, currents=currents, load_tau=load_tau, inertia=inertia, step_s=STEP_S
    )
    want = solve_ivp(
        derivatives(link, current_at, load_tau, inertia, locked),
        (0.0, times[-1]),
        tuple(start),
        method="LSODA",
        t_eval=times,
        rtol=1e-8,
        atol=(1e-10, 1e-9, 1e-9, 1.0, 1.0),
        max_step=1e-3,
    ).y.T
    scale = np.ptp(want, axis=0) + (np.array([1.0, 1.0, 0.0, 0.0, 0.0]) if locked else 0.0)
    assert np.max(np.abs(got - want) / scale, axis=0) == pytest.approx(np.zeros(5), abs=0.01)


def steady_speed(link, current_a, load_tau):
    """D (Pa - Pb) balances friction and load, and the orifice passes what sweep and leak take."""
    spool_a, side = current_a + link.null_bias_a, math.copysign(1.0, current_a)
    opening = (abs(spool_a) - link.overlap_a) / (link.full_scale_a - link.overlap_a)
    d, leak = link.displacement_m3_per_q, link.cross_leak_m3_per_s_pa + link.null_leak_m3_per_s_pa

    def excess(speed):
        dry = link.coulomb_tau + (link.breakaway_tau - link.coulomb_tau) * math.exp(-((speed / link.stribeck_q_per_s) ** 2))
        load_pa = (dry + link.viscous_tau_s_per_q * speed - side * load_tau) / d
        drop = (UNIMATE_PARAMS.supply_pressure_pa - UNIMATE_PARAMS.return_pressure_pa - load_pa) / 2.0
        return link.flow_gain_m3_per_s_sqrt_pa * opening * opening * math.sqrt(drop) - leak * load_pa - d * speed

    return side * brentq(excess, 1e-3, 2.0)


@pytest.mark.parametrize("current_a", [0.30, 0.36, -0.30, -0.36])
@pytest.mark.parametrize("index", [0, 1, 2], ids=NAMES)
def test_a_link_runs_at_the_speed_of_the_orifice_equation(index, current_a):
    """Fast enough not to stick and slip, which link 3 does at 200 mA."""
    link, load_tau = LINKS[index], (0.0, 56.0, 0.0)[index]
    travel, want = link.travel_high_q - link.travel_low_q, steady_speed(link, current_a, load_tau)
    q = link.travel_low_q + 0.05 * travel if current_a > 0.0 else link.travel_high_q - 0.05 * travel
    seconds = min(4.0, 0.85 * travel / abs(want))
    start = LinkState(q, 0.0, link.null_bias_a, 3.5e6, 3.5e6)
    got = RUN(
        state=start,
        link=link,
        machine=UNIMATE_PARAMS,
        currents=np.full(round(seconds / STEP_S), current_a),
        load_tau=load_tau,
        inertia=INERTIA[index],
        step_s=STEP_S,
    )
    assert np.mean(got[-2000:, 1]) == pytest.approx(want, rel=0.005)


def test_coriolis_and_centrifugal_loads_are_those_of_the_inertias_by_lagrange():
    """tau_i = 1/2 sum_j dM_j/dq_i q_j'^2 - sum_j dM_i/dq_j q_i' q_j' for a diagonal M(q)."""
    q, qd, nudge = np.array([0.4, 0.3, 0.6]), np.array([0.5, -0.4, 0.3]), 1e-5

    def mass(at):
        return np.array(inertias(UNIMATE_PARAMS, posture(UNIMATE_PARAMS, tuple(at))))

    slopes = np.array(
        [(mass(q + nudge * unit) - mass(q - nudge * unit)) / (2.0 * nudge) for unit in np.eye(3)]
    )  # [j, i] dM_i/dq_j
    want = 0.5 * slopes @ (qd * qd) - qd * (qd @ slopes)
    arm = posture(UNIMATE_PARAMS, tuple(q))
    assert motion_loads(UNIMATE_PARAMS, arm, inertias(UNIMATE_PARAMS, arm)[1], tuple(qd)) == pytest.approx(
        want, rel=1e-6, abs=1e-6
    )


@pytest.mark.parametrize("plate_n_per_m", [7208.0, 53150.0, 500e3])
def test_plate_and_gauge_answer_a_moving_tip_as_their_transfer_function(plate_n_per_m):
    """F / x = ke (bs s + ks) / (bs s + ks + ke)."""
    contact = contact_params(Environment("plate", plate_n_per_m, 0.0))
    times = np.arange(4001) * STEP_S
    depths = 0.005 + 0.001 * np.sin(2.0 * math.pi * 8.0 * times) + 0.0003 * np.sin(2.0 * math.pi * 31.0 * times)
    state, forces = contact_start(contact, UNIMATE_PARAMS, (1.0, 0.0, -float(depths[0]))), []
    for depth in depths:
        state = contact_step(state, contact, UNIMATE_PARAMS, (1.0, 0.0, -float(depth)), STEP_S)
        forces.append(state.force_n)
    ks, bs = UNIMATE_PARAMS.sensor_stiffness_n_per_m, UNIMATE_PARAMS.sensor_damping_ns_per_m
    moved = lsim(([plate_n_per_m * bs, plate_n_per_m * ks], [bs, ks + plate_n_per_m]), depths - depths[0], times)[1]
    want = moved + depths[0] * plate_n_per_m * ks / (plate_n_per_m + ks)
    assert np.array(forces) == pytest.approx(want, abs=0.01 * np.ptp(want))


def test_a_sliding_crate_moves_as_its_differential_equation():
    """m v' = ks p + bs p' - mu m g while the tip drives it."""
    environment = Environment("crate", surface_m=0.0)
    contact, step_s = contact_params(environment), 1e-5
    ks, bs, mass = UNIMATE_PARAMS.sensor_stiffness_n_per_m, UNIMATE_PARAMS.sensor_damping_ns_per_m, environment.crate_mass_kg
    sliding_n = environment.crate_kinetic_friction * mass * 9.81

    def tip(t):
        return 0.008 + 0.3 * t + 0.004 * math.sin(9.0 * t), 0.3 + 0.036 * math.cos(9.0 * t)

    def rate(t, state):
        x, v = state
        at, speed = tip(t)
        return v, (ks * (at - x) + bs * (speed - v) - sliding_n) / mass

    state, found, count = contact_start(contact, UNIMATE_PARAMS, (tip(0.0)[0], 0.0, 0.0)), [], round(0.3 / step_s)
    state = state._replace(environment_m_per_s=0.3)
    for row in range(1, count + 1):
        state = contact_step(state, contact, UNIMATE_PARAMS, (tip(row * step_s)[0], 0.0, 0.0), step_s)
        found.append((state.environment_m, state.environment_m_per_s))
    times = np.arange(1, count + 1) * step_s
    want = solve_ivp(rate, (0.0, times[-1]), (0.0, 0.3), t_eval=times, rtol=1e-9, atol=1e-12, max_step=1e-3).y.T
    assert np.min(want[:, 1]) > 0.0  # it slides all the way
    assert np.array(found) == pytest.approx(want, abs=2e-3 * np.max(want))
