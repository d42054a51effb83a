"""A cylinder whose rod takes part of one piston side: forces balance and flows go on, by hand calculation."""

import math

import pytest

from hydrohil.services.plant.hydraulics import LinkState, port_area
from hydrohil.services.plant.machine import link_step, machine_start
from hydrohil.services.plant.mechanism import gravity_loads, posture
from hydrohil.services.plant.params import UNIMATE_PARAMS, Environment, contact_params
from hydrohil.shared.units import SUBSTEP_S

FREE = contact_params(Environment("free"))
POSE = (0.0, 0.1, 0.6)
INERTIA = 300.0
CURRENT_A = 0.3
SETTLES_S = 0.6
STIFF_OIL_PA = 3.2e9  # rings for a twentieth of a second instead of half of one


def cylinder(ratio):
    """The turning link without leaks and friction, and with as much travel as the trial needs."""
    return UNIMATE_PARAMS.rotate._replace(
        area_ratio=ratio,
        bulk_modulus_pa=STIFF_OIL_PA,
        cross_leak_m3_per_s_pa=0.0,
        null_leak_m3_per_s_pa=0.0,
        coulomb_tau=0.0,
        breakaway_tau=0.0,
        viscous_tau_s_per_q=0.0,
        travel_low_q=-3.0,
        travel_high_q=3.0,
    )


def steady(ratio, current_a, load=0.0):
    """The link after it has come to a steady speed."""
    link, state = cylinder(ratio), LinkState(0.0, 0.0, 0.0, 3.5e6, 3.5e6)
    for _ in range(round(SETTLES_S / SUBSTEP_S)):
        state = link_step(state, link, UNIMATE_PARAMS, current_a, load, INERTIA, step_s=SUBSTEP_S)
    return link, state


@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0])
def test_the_machine_starts_with_pressures_that_carry_the_load_on_unequal_areas(ratio):
    links = {name: getattr(UNIMATE_PARAMS, name)._replace(area_ratio=ratio) for name in ("rotate", "down_up", "out_in")}
    machine = UNIMATE_PARAMS._replace(**links)
    start = machine_start(machine, FREE, POSE)
    loads = gravity_loads(machine, posture(machine, POSE))
    for link, load, a_pa, b_pa in zip(links.values(), loads, start.pressure_a_pa, start.pressure_b_pa, strict=True):
        assert link.displacement_m3_per_q * (a_pa - ratio * b_pa) + load == pytest.approx(0.0, abs=1e-6)
        assert a_pa + b_pa == pytest.approx(machine.supply_pressure_pa + machine.return_pressure_pa)


@pytest.mark.parametrize("ratio", [0.5, 0.7, 1.0, 1.5])
@pytest.mark.parametrize("load", [0.0, 800.0, -800.0])
def test_at_a_steady_speed_the_pressures_carry_the_load_and_each_port_passes_what_its_side_sweeps(ratio, load):
    link, state = steady(ratio, CURRENT_A, load)
    displacement, gain = link.displacement_m3_per_q, link.flow_gain_m3_per_s_sqrt_pa * port_area(link, state.spool_a)
    assert displacement * (state.pressure_a_pa - ratio * state.pressure_b_pa) + load == pytest.approx(0.0, abs=2.0)
    into_a = gain * math.sqrt(UNIMATE_PARAMS.supply_pressure_pa - state.pressure_a_pa)
    out_of_b = gain * math.sqrt(state.pressure_b_pa)
    assert into_a == pytest.approx(displacement * state.qd, rel=2e-3)
    assert out_of_b == pytest.approx(ratio * displacement * state.qd, rel=2e-3)


@pytest.mark.parametrize("ratio", [0.5, 0.7, 1.0, 1.5])
def test_without_load_it_goes_out_and_in_at_the_speeds_of_the_orifice_equation(ratio):
    """v = K a / D sqrt(Ps / (1 + r^3)) with A at the supply, and sqrt(Ps / (r^2 + 1 / r)) with B there."""
    supply_pa = UNIMATE_PARAMS.supply_pressure_pa
    for current_a, share in ((CURRENT_A, 1.0 + ratio**3), (-CURRENT_A, ratio**2 + 1.0 / ratio)):
        link, state = steady(ratio, current_a)
        gain = link.flow_gain_m3_per_s_sqrt_pa * abs(port_area(link, state.spool_a))
        assert abs(state.qd) == pytest.approx(gain / link.displacement_m3_per_q * math.sqrt(supply_pa / share), rel=2e-3)
        assert state.qd * current_a > 0.0
