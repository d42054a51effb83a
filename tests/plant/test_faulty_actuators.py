"""Broken valves, leaks and a lost supply against the orifice equation, analytically."""

import math

import pytest

from hydrohil.services.plant.faults import fault_row
from hydrohil.services.plant.faulty_actuators import faulty_codes, faulty_machine
from hydrohil.services.plant.machine import machine_start
from hydrohil.services.plant.params import UNIMATE_PARAMS
from hydrohil.shared.contract.faults import CONVERTERS, VALVES, Fault
from hydrohil.shared.units import SUBSTEP_S
from tests.plant.test_machine import FREE, LINKS, ONE_METRE, SECOND, SHUT, one_of, run

PERIOD_NS = 4_500_000
RAMP_A_PER_S = 0.005
STEPS = 200  # sub-steps between two changes of a ramp's current


def table(*faults):
    return tuple(fault_row(fault, 1, PERIOD_NS) for fault in faults)


def broken(*faults, tick=0):
    return faulty_machine(table(*faults), tick, UNIMATE_PARAMS)


def steady(machine, index, current_a):
    """The machine after 1.5 s of constant current."""
    return run(
        machine_start(UNIMATE_PARAMS, FREE, ONE_METRE), machine, FREE, one_of(index, current_a), SECOND * 3 // 2, SUBSTEP_S
    )


def orifice_speed(machine, current_a):
    """Steady speed of link 1:  D v = K_q a sqrt((Ps - PL) / 2) - Cl PL,  D PL = Coulomb friction + viscous friction."""
    link = machine.rotate
    part = (current_a + link.null_bias_a - link.overlap_a) / (link.full_scale_a - link.overlap_a)
    speed = 0.0
    for _ in range(200):
        load_pa = (link.coulomb_tau + link.viscous_tau_s_per_q * speed) / link.displacement_m3_per_q
        flow = link.flow_gain_m3_per_s_sqrt_pa * part**2 * math.sqrt((machine.supply_pressure_pa - load_pa) / 2.0)
        speed += 0.5 * ((flow - link.cross_leak_m3_per_s_pa * load_pa) / link.displacement_m3_per_q - speed)
    return speed


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 0.8])
def test_what_is_left_of_the_supply_sets_the_speed_as_the_root_of_its_pressure(share):
    machine = broken(Fault("drop", "supply", value=share))
    assert machine.supply_pressure_pa == pytest.approx((1.0 - share) * UNIMATE_PARAMS.supply_pressure_pa)
    speed = steady(machine, 0, 0.3).qd[0]
    assert speed == pytest.approx(orifice_speed(machine, 0.3), rel=0.02)
    assert speed < 1.001 * math.sqrt(1.0 - share) * steady(UNIMATE_PARAMS, 0, 0.3).qd[0]


def test_without_a_supply_a_moving_link_stops_and_a_standing_one_stays():
    dead = broken(Fault("drop", "supply", value=1.0))
    moving = steady(UNIMATE_PARAMS, 0, 0.3)
    assert moving.qd[0] > 0.1
    after = run(moving, dead, FREE, one_of(0, 0.3), SECOND, SUBSTEP_S)
    assert after.qd[0] == 0.0
    assert run(after, dead, FREE, one_of(0, 0.36), SECOND, SUBSTEP_S).q[0] == after.q[0]


def break_away_a(machine, index):
    """Current at which a slow ramp moves the link."""
    state, current_a = machine_start(UNIMATE_PARAMS, FREE, ONE_METRE), 0.0
    while state.qd[index] == 0.0 and current_a < 0.6:
        current_a += RAMP_A_PER_S * STEPS * SUBSTEP_S
        state = run(state, machine, FREE, one_of(index, current_a), STEPS, SUBSTEP_S)
    return current_a


@pytest.mark.parametrize("times", [1.0, 5.0, 25.0])
def test_a_leak_raises_the_break_away_current_until_the_port_feeds_it(times):
    """At break-away K_q a(u) sqrt((Ps - PL) / 2) = Cl PL with D PL = break-away torque."""
    machine = broken(Fault("leak", "valve_rotate", value=times))
    link = machine.rotate
    assert link.cross_leak_m3_per_s_pa == times * UNIMATE_PARAMS.rotate.cross_leak_m3_per_s_pa
    load_pa = link.breakaway_tau / link.displacement_m3_per_q
    root = math.sqrt((machine.supply_pressure_pa - load_pa) / 2.0)
    part = math.sqrt(link.cross_leak_m3_per_s_pa * load_pa / (link.flow_gain_m3_per_s_sqrt_pa * root))
    expected_a = link.overlap_a - link.null_bias_a + part * (link.full_scale_a - link.overlap_a)
    found_a = break_away_a(machine, 0)
    assert found_a == pytest.approx(expected_a, rel=0.05)
    assert times == 1.0 or found_a > break_away_a(UNIMATE_PARAMS, 0)


@pytest.mark.parametrize("index", [0, 1, 2])
def test_the_largest_leak_of_the_table_is_no_trouble_for_the_sub_step(index):
    machine = broken(Fault("leak", VALVES[index], value=1000.0))
    for current_a in (0.36, -0.36):
        state = steady(machine, index, current_a)
        pressures = state.pressure_a_pa + state.pressure_b_pa
        assert min(pressures) >= 0.0 and max(pressures) <= UNIMATE_PARAMS.supply_pressure_pa
        assert state.pressure_a_pa[index] == pytest.approx(state.pressure_b_pa[index], rel=0.1)  # the leak joins them
        assert abs(state.qd[index]) < abs(steady(UNIMATE_PARAMS, index, current_a).qd[index]) + 1e-12


@pytest.mark.parametrize("index", [0, 2])
def test_a_stuck_spool_goes_on_feeding_when_the_current_is_gone(index):
    moving = run(
        machine_start(UNIMATE_PARAMS, FREE, ONE_METRE), UNIMATE_PARAMS, FREE, one_of(index, 0.25), SECOND * 3 // 4, SUBSTEP_S
    )
    stuck = broken(Fault("stuck", VALVES[index]))
    after = run(moving, stuck, FREE, SHUT, SECOND // 2, SUBSTEP_S)
    assert after.spool_a[index] == moving.spool_a[index]
    assert after.qd[index] == pytest.approx(moving.qd[index], rel=0.1)
    assert moving.qd[index] > 0.05
    sound = run(moving, UNIMATE_PARAMS, FREE, SHUT, SECOND // 2, SUBSTEP_S)
    assert sound.qd[index] == 0.0


def test_a_spool_stuck_at_null_moves_nothing_whatever_the_current():
    stuck = broken(Fault("stuck", "valve_rotate"))
    state = steady(stuck, 0, 0.36)
    assert (state.q[0], state.spool_a[0]) == (ONE_METRE[0], UNIMATE_PARAMS.rotate.null_bias_a)


@pytest.mark.parametrize("index", [0, 1, 2])
def test_a_stuck_converter_holds_its_own_code_and_lets_the_others_be(index):
    rows = table(Fault("stuck", CONVERTERS[index]))
    standing, written = (2100, 2200, 2300), (900, 1000, 1100)
    assert faulty_codes(rows, 0, written, standing) == tuple(standing[k] if k == index else written[k] for k in range(3))


def test_nothing_is_broken_before_its_first_tick_nor_after_its_last():
    faults = (
        Fault("drop", "supply", 0.45, 0.09, 0.5),
        Fault("leak", "valve_out_in", 0.45, 0.09, 9.0),
        Fault("stuck", "valve_down_up", 0.45, 0.09),
        Fault("stuck", "dac_rotate", 0.45, 0.09),
    )
    for tick, acts in ((99, False), (100, True), (119, True), (120, False)):
        machine = broken(*faults, tick=tick)
        assert (machine != UNIMATE_PARAMS) is acts
        assert (faulty_codes(table(*faults), tick, (1, 2, 3), (7, 8, 9)) == (7, 2, 3)) is acts
    assert math.isinf(broken(*faults, tick=100).down_up.valve_lag_s)


def test_a_fault_of_one_link_leaves_the_others_as_they_are():
    for index, target in enumerate(VALVES):
        for kind, value in (("leak", 3.0), ("stuck", 0.0)):
            machine = broken(Fault(kind, target, value=value))
            assert [machine[k] == LINKS[k] for k in range(3)] == [k != index for k in range(3)]
