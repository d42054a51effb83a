"""The linearised model against python-control, against itself in another form, and against the nonlinear plant."""

import math

import control
import numpy as np
import pytest
from scipy.optimize import brentq

from hydrohil.linear.blocks import arm_polynomials, blocks, responses
from hydrohil.linear.bode import bode_data, save_bode
from hydrohil.linear.closed_loop import GRID, closed_loop, is_stable, loop_margins, margins, poles, steady
from hydrohil.linear.linear import Arm, OperatingPoint, actuator, linear_model
from hydrohil.services.plant.hydraulics import LinkState, port_area, port_flows
from hydrohil.services.plant.machine import link_step
from hydrohil.services.plant.params import UNIMATE_PARAMS
from hydrohil.simulation.rollout import rollout
from hydrohil.thesis.library import find

LINK = UNIMATE_PARAMS.down_up
NAMES = ("fig-5-2", "fig-5-5", "fig-5-6", "fig-5-9", "fig-5-13")
EFFECTIVE = 7208.0 * 46e3 / (7208.0 + 46e3)
FAST = OperatingPoint(0.250)


def changed(name, **impedance):
    """A shipped experiment with other fields of its target impedance."""
    controller = find(name).controller
    return find(name)._replace(controller=controller._replace(impedance=controller.impedance._replace(**impedance)))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("spool_a", [0.100, 0.250])
@pytest.mark.parametrize("impedance", [{}, {"formulation": "measured"}, {"force_filter": "butterworth", "force_cutoff_hz": 3.0}])
def test_state_space_and_the_formulae_of_the_thesis_are_one_system(name, spool_a, impedance):
    model = linear_model(changed(name, **impedance), OperatingPoint(spool_a))
    angular = np.array([0.01, 0.3, 2.0, 9.0, 40.0, 200.0])
    response, states = responses(blocks(model), angular), closed_loop(model)(1j * angular)
    for row, column, expected in (
        (0, 0, response.x_per_x_d),
        (0, 1, response.x_per_f_d),
        (1, 0, response.f_per_x_d),
        (1, 1, response.f_per_f_d),
    ):
        assert states[row, column] == pytest.approx(expected, rel=1e-8, abs=1e-14)


def test_contact_is_the_fourth_order_of_the_thesis_and_free_motion_the_second():
    arm = Arm(
        mass_kg=100.0,
        damping_ns_per_m=30.0,
        stiffness_n_per_m=20.0,
        sensor_stiffness_n_per_m=46e3,
        sensor_damping_ns_per_m=600.0,
        environment_mass_kg=64.0,
        environment_damping_ns_per_m=5.0,
        environment_stiffness_n_per_m=7e3,
    )
    above_x, above_f, below = arm_polynomials(arm)
    s = 3.0 + 2.0j
    inner, outer = 64.0 * s**2 + 605.0 * s + 53e3, 100.0 * s**2 + 30.0 * s + 20.0
    around, sensor = 64.0 * s**2 + 5.0 * s + 7e3, 600.0 * s + 46e3
    assert len(below) == 5
    assert np.polyval(above_x, s) == pytest.approx(inner)
    assert np.polyval(above_f, s) == pytest.approx(sensor * around)
    assert np.polyval(below, s) == pytest.approx(inner * outer + around * sensor)
    free = arm._replace(environment_mass_kg=0.0, environment_damping_ns_per_m=0.0, environment_stiffness_n_per_m=0.0)
    assert [list(part) for part in arm_polynomials(free)] == [[1.0], [0.0], [100.0, 30.0, 20.0]]


def test_margins_are_python_controls():
    loop = control.tf([8.0], [1.0, 3.0, 2.0]) * control.tf([1.0], [0.1, 1.0])
    gain, phase_deg, modulus, gain_at, phase_at, _ = control.stability_margins(loop)
    found = margins(loop(1j * GRID))
    assert found == pytest.approx((gain, phase_deg, modulus, gain_at, phase_at), rel=1e-4)


def test_an_unstable_loop_has_a_negative_phase_margin():
    loop = control.tf([80.0], [1.0, 3.0, 2.0]) * control.tf([1.0], [0.1, 1.0])
    found = margins(loop(1j * GRID))
    assert found.gain < 1.0 and found.phase_deg < 0.0


def test_at_the_gain_margin_the_closed_loop_stands_on_the_edge():
    model = linear_model(find("fig-5-2"))
    gain = loop_margins(model)[1].gain
    for factor, stable in ((0.99, True), (1.01, False)):
        law = model.position
        by = factor * gain
        louder = law._replace(proportional_a_per_m=by * law.proportional_a_per_m, integral_a_per_m_s=by * law.integral_a_per_m_s)
        assert is_stable(model._replace(position=louder)) == stable


def test_at_rest_springs_share_the_load():
    """x = F_d / k in free space;  f = F_d k_eff / (k + k_eff) on the plate, times the compensation (thesis 5.3, 6.3)."""
    assert steady(linear_model(find("fig-5-2"))).x_per_f_d_m_per_n == pytest.approx(1.0 / 500.0)
    model = linear_model(find("fig-5-5"))
    plain = model._replace(target=model.target._replace(force_gain=1.0))
    assert steady(plain).f_per_f_d == pytest.approx(EFFECTIVE / (50e3 + EFFECTIVE))
    assert steady(model).f_per_f_d == pytest.approx(EFFECTIVE / (50e3 + EFFECTIVE) * (50e3 + 6200.0) / 6200.0)


def test_at_rest_neither_filter_nor_formulation_changes_the_share():
    expected = steady(linear_model(find("fig-5-5"), FAST)).f_per_f_d
    for impedance in ({"formulation": "measured"}, {"force_filter": "butterworth"}, {"force_filter": "bounded"}):
        assert steady(linear_model(changed("fig-5-5", **impedance), FAST)).f_per_f_d == pytest.approx(expected)


def test_the_alternate_formulations_model_integrates_twice_where_the_first_ends():
    """thesis 6.2.2: (M_X + 1) H + M_F has no finite steady state."""
    first, alternate = (blocks(linear_model(changed("fig-5-5", formulation=f))) for f in ("setpoint", "measured"))
    assert abs(first.model_f(1e-4j)) == pytest.approx(1.0 / 50e3, rel=1e-3)
    assert abs(alternate.model_f(1e-4j)) == pytest.approx(1.0 / (500.0 * 1e-8))


def test_in_free_space_the_target_impedance_is_a_pole_of_the_whole():
    found = [pole for pole in poles(linear_model(find("fig-5-2"))) if pole.frequency_rad_per_s == pytest.approx(2.0, rel=1e-6)]
    assert [pole.damping_ratio for pole in found] == pytest.approx([0.3])


def test_the_thesis_model_has_neither_delay_nor_spool():
    model = linear_model(find("fig-5-5"))
    assert len(poles(model.as_in_the_thesis())) < len(poles(model))
    assert model.position.delay_s == pytest.approx(0.0036 + 0.0045 / 2)  # latch at 0.8 of the period


def test_a_shut_port_and_a_stalled_actuator_are_refused_by_number():
    with pytest.raises(ValueError, match="36 mA"):
        linear_model(find("fig-5-5"), OperatingPoint(LINK.overlap_a))
    with pytest.raises(ValueError, match="stalls"):
        linear_model(find("fig-5-5"), OperatingPoint(0.1, 7e6))
    with pytest.raises(ValueError, match="impedance"):
        linear_model(find("fig-4-2"))


@pytest.mark.parametrize("load_pa", [0.0, 1.5e6])
def test_the_orifice_is_linearised_where_it_is_taken(load_pa):
    point, nudge = OperatingPoint(0.150, load_pa), 1e-4
    found = actuator(UNIMATE_PARAMS, LINK, 0.0, 1.0, point)

    def flow(spool_a, load):
        middle = (7e6 + load) / 2.0, (7e6 - load) / 2.0
        gain = LINK.flow_gain_m3_per_s_sqrt_pa * port_area(LINK, spool_a)
        return port_flows(gain, middle, (7e6, 0.0), UNIMATE_PARAMS.root_smoothing_pa)[0]

    slope = (flow(0.150 + nudge, load_pa) - flow(0.150 - nudge, load_pa)) / (2.0 * nudge)
    droop = (flow(0.150, load_pa + 100.0) - flow(0.150, load_pa - 100.0)) / 200.0
    assert found.flow_m3_per_s_a == pytest.approx(slope, rel=1e-4)
    assert found.leak_m3_per_s_pa - LINK.cross_leak_m3_per_s_pa - LINK.null_leak_m3_per_s_pa == pytest.approx(-droop, rel=1e-3)


def steady_speed(current_a):
    """(speed, load pressure) of link 2 running at constant current, from the orifice equation and the balance of forces."""
    spool_a = current_a + LINK.null_bias_a

    def excess(speed):
        load = (LINK.coulomb_tau + LINK.viscous_tau_s_per_q * speed) / LINK.displacement_m3_per_q
        flow = LINK.flow_gain_m3_per_s_sqrt_pa * port_area(LINK, spool_a) * math.sqrt((7e6 - load) / 2.0)
        return flow - (LINK.cross_leak_m3_per_s_pa + LINK.null_leak_m3_per_s_pa) * load - LINK.displacement_m3_per_q * speed

    speed = brentq(excess, 0.0, 1.0)
    return speed, (LINK.coulomb_tau + LINK.viscous_tau_s_per_q * speed) / LINK.displacement_m3_per_q


@pytest.mark.parametrize("frequency_hz", [0.7, 3.0, 8.0])
def test_a_small_sine_of_current_shakes_the_running_link_as_the_linear_actuator_says(frequency_hz):
    """V/U = s R_X A / (1 + R_X A Q_v) / (tau s + 1), against the nonlinear valve, chambers and friction sub-step by sub-step."""
    current_a, shake_a, step_s = 0.200, 0.002, 50e-6  # fast enough for friction not to fall with speed
    speed, load_pa = steady_speed(current_a)
    inertia, period_s = 111.0, 1.0 / frequency_hz
    state = LinkState(0.0, speed, current_a + LINK.null_bias_a, (7e6 + load_pa) / 2.0, (7e6 - load_pa) / 2.0)
    angular, rows = 2.0 * math.pi * frequency_hz, []
    settle_s = max(1.2, 2.0 * period_s)
    for step in range(round((settle_s + period_s) / step_s)):
        t = step * step_s
        state = link_step(
            state=state,
            link=LINK,
            machine=UNIMATE_PARAMS,
            current_a=current_a + shake_a * math.sin(angular * t),
            load_tau=0.0,
            inertia_tau_s2_per_q=inertia,
            step_s=step_s,
        )
        state = state._replace(q=0.0)  # so that the volumes do not change
        rows.append((t + step_s, state.qd))
    t, v = np.array(rows).T
    last = t > settle_s
    waves = np.column_stack((np.sin(angular * t[last]), np.cos(angular * t[last]), np.ones(last.sum())))
    along, across, mean = np.linalg.lstsq(waves, v[last])[0]
    a = actuator(UNIMATE_PARAMS, LINK, 0.0, 1.0, OperatingPoint(current_a + LINK.null_bias_a, load_pa))
    s = 1j * angular
    force = a.flow_m3_per_s_a * a.area_m2 / (a.half_compressibility_m3_per_pa * s + a.leak_m3_per_s_pa)
    robot = 1.0 / (inertia * s + LINK.viscous_tau_s_per_q)  # s R_X
    expected = robot * force / (1.0 + robot * force * a.area_m2 / a.flow_m3_per_s_a) / (LINK.valve_lag_s * s + 1.0) * shake_a
    assert mean == pytest.approx(speed, rel=0.01)
    assert complex(along, across) == pytest.approx(expected, abs=0.02 * abs(expected))


@pytest.mark.parametrize(("name", "worst_m"), [("fig-5-2", 0.004), ("fig-5-3", 0.004), ("fig-5-4", 0.004)])
def test_in_free_space_the_rig_moves_as_the_linear_model_to_a_fiftieth(name, worst_m):
    """100 N on 500 N/m: rms over the whole trial, against 0.2 m."""
    experiment = find(name)
    trace = rollout(experiment, 0)
    times = np.arange(0.0, experiment.duration_s, 0.002)
    inputs = np.vstack((np.zeros_like(times), np.where(times >= 0.5, 100.0, 0.0)))
    modelled = control.forced_response(closed_loop(linear_model(experiment, FAST)), times, inputs).outputs[0]
    moved = trace.x_m[0, 2] - trace.x_m[:, 2]  # down is positive
    assert np.sqrt(np.mean((moved - np.interp(trace.t_s, times, modelled)) ** 2)) < worst_m


@pytest.mark.parametrize("name", ["fig-5-5", "fig-5-6"])
def test_on_the_plate_the_force_follows_the_linear_model_to_a_tenth(name):
    experiment = find(name)
    trace = rollout(experiment, 0)
    times = np.arange(0.0, experiment.duration_s, 0.002)
    inputs = np.vstack((np.zeros_like(times), np.where(times >= 0.5, 100.0, 0.0)))
    modelled = control.forced_response(closed_loop(linear_model(experiment)), times, inputs).outputs[1]
    off = trace.force_n - np.interp(trace.t_s, times, modelled)
    assert np.sqrt(np.mean(off * off)) < 10.0  # of 100 N, with 5 N of noise in it


def test_bode_data_are_gain_and_phase_of_the_responses_and_make_a_picture(tmp_path):
    model = linear_model(find("fig-5-5"))
    lines = {line.label: line for line in bode_data(model, 0.01, 30.0)}
    assert lines["F/F_d"].gain_db[0] == pytest.approx(20.0 * math.log10(steady(model).f_per_f_d), abs=0.05)
    assert lines["F/F_d"].gain_db[-1] < -40.0
    assert "F/F_d" not in {line.label for line in bode_data(linear_model(find("fig-5-2")), 0.01, 30.0)}
    save_bode(model, tmp_path / "bode.png", "plate", (0.01, 30.0))
    assert (tmp_path / "bode.png").read_bytes().startswith(b"\x89PNG")
