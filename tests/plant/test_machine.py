import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hydrohil.services.plant.contact import ContactState
from hydrohil.services.plant.hydraulics import LinkState
from hydrohil.services.plant.machine import (
    MachineState,
    advance,
    advance_by,
    ground_truth,
    inside,
    machine_start,
    sense,
    stopped,
    tip_position,
)
from hydrohil.services.plant.mechanism import gravity_loads, inertias, posture
from hydrohil.services.plant.params import UNIMATE_PARAMS, Environment, contact_params
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.units import GRAVITY_M_PER_S2, RAD_PER_DEG, SUBSTEP_S

run = compiled(advance_by)
advance_compiled, sense_compiled, ground_truth_compiled = compiled(advance), compiled(sense), compiled(ground_truth)

FREE = contact_params(Environment("free"))
ONE_METRE = (0.0, 0.0, 0.212)  # level, d3' = 1 m
SHUT = (0.0, 0.0, 0.0)
SHUT_CODES = (2048, 2048, 2048)
LINKS = (UNIMATE_PARAMS.rotate, UNIMATE_PARAMS.down_up, UNIMATE_PARAMS.out_in)
POSES = [ONE_METRE, (0.0, 0.0, 1.04), (1.9, 0.47, 1.04), (-1.9, -0.52, 0.0), (0.5, 0.3, 0.6)]
SECOND = round(1.0 / SUBSTEP_S)


def plate(stiffness=7208.0, surface_m=-0.37):
    return contact_params(Environment("plate", stiffness_n_per_m=stiffness, surface_m=surface_m))


def crate(surface_m=1.0):
    return contact_params(Environment("crate", surface_m=surface_m))


def one_of(index, value):
    return tuple(value if i == index else 0.0 for i in range(3))


def without_losses(machine):
    def bare(link):
        return link._replace(
            cross_leak_m3_per_s_pa=0.0, null_leak_m3_per_s_pa=0.0, coulomb_tau=0.0, breakaway_tau=0.0, viscous_tau_s_per_q=0.0
        )

    return machine._replace(rotate=bare(machine.rotate), down_up=bare(machine.down_up), out_in=bare(machine.out_in))


@pytest.mark.parametrize("q", POSES)
def test_a_machine_with_shut_valves_does_not_creep_at_all(q):
    start = machine_start(UNIMATE_PARAMS, FREE, q)
    after = run(start, UNIMATE_PARAMS, FREE, SHUT, 2 * SECOND, SUBSTEP_S)
    assert after.q == start.q
    assert after.qd == SHUT


@pytest.mark.parametrize("contact", [plate(), plate(53150.0), crate(0.998)])
def test_a_machine_that_starts_in_contact_holds_its_force(contact):
    q = (0.0, 0.004, 0.212)
    start = machine_start(UNIMATE_PARAMS, contact, q)
    after = run(start, UNIMATE_PARAMS, contact, SHUT, 2 * SECOND, SUBSTEP_S)
    assert start.contact.force_n > 20.0
    assert after.q == start.q
    assert after.contact == pytest.approx(start.contact)


@pytest.mark.parametrize("q", POSES)
def test_the_pressures_of_the_start_carry_the_weight(q):
    """D (Pa - Pb) = -load: without friction and leak nothing accelerates."""
    start = machine_start(UNIMATE_PARAMS, FREE, q)
    weight = gravity_loads(UNIMATE_PARAMS, posture(UNIMATE_PARAMS, q))
    for link, a, b, load in zip(LINKS, start.pressure_a_pa, start.pressure_b_pa, weight, strict=True):
        assert link.displacement_m3_per_q * (a - b) == pytest.approx(-load, abs=1e-6)
        assert a + b == pytest.approx(UNIMATE_PARAMS.supply_pressure_pa)
    bare = without_losses(UNIMATE_PARAMS)
    after = run(start, bare, FREE, SHUT, SECOND // 2, SUBSTEP_S)
    assert after.q == pytest.approx(q, abs=1e-9)


@pytest.mark.parametrize("contact", [plate(), plate(53150.0), crate(1.009)])
def test_the_pressures_of_the_start_carry_the_push_of_the_environment(contact):
    q, bare = (0.1, 0.004, 0.23), without_losses(UNIMATE_PARAMS)
    pushed = machine_start(bare, contact, q)
    after = run(pushed, bare, contact, SHUT, SECOND // 2, SUBSTEP_S)
    assert pushed.contact.force_n > 20.0
    assert after.q[1:] == pytest.approx(q[1:], abs=1e-9)
    let_go = run(pushed, bare, FREE, SHUT, SECOND // 2, SUBSTEP_S)
    assert let_go.q[1:] != pytest.approx(q[1:], abs=1e-9)


def test_viscous_friction_alone_brakes_exponentially():
    bare = without_losses(UNIMATE_PARAMS)
    soft = bare.rotate._replace(bulk_modulus_pa=1e-3, viscous_tau_s_per_q=1500.0)  # chambers that do not resist
    machine = bare._replace(rotate=soft)
    state = machine_start(machine, FREE, ONE_METRE)._replace(qd=(0.2, 0.0, 0.0))
    inertia = inertias(machine, posture(machine, ONE_METRE))[0]
    after = run(state, machine, FREE, SHUT, SECOND // 5, SUBSTEP_S)
    assert after.qd[0] == pytest.approx(0.2 * math.exp(-1500.0 / inertia / 5), rel=1e-2)


def test_a_start_outside_the_travel_is_refused_by_name():
    machine_start(UNIMATE_PARAMS, FREE, (0.0, 0.0, 1.04))
    with pytest.raises(ValueError, match=r"out_in starts at 1\.05 m"):
        machine_start(UNIMATE_PARAMS, FREE, (0.0, 0.0, 1.05))


@pytest.mark.parametrize("index", [0, 1, 2])
def test_a_shut_link_rings_at_its_hydraulic_frequency(index):
    """w = sqrt(beta D^2 (1 / Va + 1 / Vb) / M) where nothing is lost."""
    bare, link, q = without_losses(UNIMATE_PARAMS)._replace(counterbalance_kg_m=45.0 * 0.3), LINKS[index], ONE_METRE
    d = link.displacement_m3_per_q
    volumes = [
        link.dead_volume_m3 + d * (q[index] - link.travel_low_q),
        link.dead_volume_m3 + d * (link.travel_high_q - q[index]),
    ]
    inertia = inertias(bare, posture(bare, q))[index]
    angular = math.sqrt(link.bulk_modulus_pa * d * d * (1 / volumes[0] + 1 / volumes[1]) / inertia)
    state = machine_start(bare, FREE, q)._replace(qd=one_of(index, 1e-3))
    crossings, at = [], 0
    while len(crossings) < 11:
        before = state.qd[index]
        state, at = run(state, bare, FREE, SHUT, 1, SUBSTEP_S), at + 1
        if before < 0.0 <= state.qd[index]:
            crossings.append(at * SUBSTEP_S)
    assert (crossings[-1] - crossings[0]) / 10 == pytest.approx(2 * math.pi / angular, rel=0.01)


@pytest.mark.parametrize("index", [0, 1, 2])
def test_a_moving_link_comes_to_rest_when_its_valve_shuts(index):
    state = machine_start(UNIMATE_PARAMS, FREE, ONE_METRE)._replace(qd=one_of(index, 0.2))
    after = run(state, UNIMATE_PARAMS, FREE, SHUT, 2 * SECOND, SUBSTEP_S)
    assert after.qd == SHUT
    assert abs(after.q[index] - ONE_METRE[index]) < 0.02


SPEEDS = [(0, 24 * RAD_PER_DEG), (1, 21 * RAD_PER_DEG), (2, 0.38)]


def speed_at(machine, index, current_a):
    link = (machine.rotate, machine.down_up, machine.out_in)[index]
    middle = (link.travel_low_q + link.travel_high_q) / 2
    q = tuple(middle if i == index else value for i, value in enumerate(ONE_METRE))
    state = run(machine_start(machine, FREE, q), machine, FREE, one_of(index, current_a), SECOND // 2, SUBSTEP_S)
    return state.qd[index]


@pytest.mark.parametrize(("index", "speed"), SPEEDS)
def test_the_machine_runs_near_its_no_load_speed_at_360_ma(index, speed):
    """Friction, leak, weight and the null's bias keep it from the valve's own speed."""
    assert 0.75 * speed < speed_at(UNIMATE_PARAMS, index, 0.36) < 1.1 * speed
    assert -1.1 * speed < speed_at(UNIMATE_PARAMS, index, -0.36) < -0.75 * speed


def test_more_supply_pressure_is_more_speed_through_the_same_valve():
    """v goes with sqrt(Ps) where nothing is lost, for the valve's gain is its own."""
    bare = without_losses(UNIMATE_PARAMS)
    strong = bare._replace(supply_pressure_pa=7.5e6)
    assert speed_at(strong, 0, 0.36) / speed_at(bare, 0, 0.36) == pytest.approx(math.sqrt(7.5 / 7.0), rel=0.01)


def break_away_a(index, sign):
    """Current at which a ramp of 10 mA/s has moved a link by a count."""
    count = (0.0281778 * RAD_PER_DEG, 0.0284006 * RAD_PER_DEG, 0.00105)[index]
    state = run(machine_start(UNIMATE_PARAMS, FREE, ONE_METRE), UNIMATE_PARAMS, FREE, SHUT, 2 * SECOND, SUBSTEP_S)
    rest, step = state.q[index], SECOND // 100
    for hundredth in range(3000):
        current_a = sign * 0.010 * hundredth / 100
        state = run(state, UNIMATE_PARAMS, FREE, one_of(index, current_a), step, SUBSTEP_S)
        if abs(state.q[index] - rest) > count:
            assert math.copysign(1.0, state.q[index] - rest) == sign
            return abs(current_a)
    return math.inf


# Table 2 has 88/88 mA, 88/114 mA (down, up) and 141/176 mA (out, in): the machine must not be off by more than a sixth
@pytest.mark.parametrize(
    ("index", "sign", "table_a"),
    [(0, 1, 0.088), (0, -1, 0.088), (1, 1, 0.088), (1, -1, 0.114), (2, 1, 0.141), (2, -1, 0.176)],
)
def test_a_slow_ramp_breaks_away_near_the_current_of_table_2(index, sign, table_a):
    assert break_away_a(index, sign) == pytest.approx(table_a, rel=1 / 6)


@pytest.mark.parametrize("contact", [FREE, plate(), crate(1.2)])
def test_pressures_stay_between_vacuum_and_the_supply_however_the_valves_swing(contact):
    state = machine_start(UNIMATE_PARAMS, contact, ONE_METRE)
    for swing in range(60):
        codes = (3276, 820, 3276) if swing % 2 else (820, 3276, 820)
        state = advance_compiled(state, UNIMATE_PARAMS, contact, codes, 1 + 97 * swing)
        pressures = state.pressure_a_pa + state.pressure_b_pa
        assert min(pressures) >= 0.0 and max(pressures) < UNIMATE_PARAMS.supply_pressure_pa


@pytest.mark.parametrize("index", [0, 1, 2])
def test_the_end_of_travel_stops_a_link_and_lets_it_come_back(index):
    link = LINKS[index]
    at_end = run(machine_start(UNIMATE_PARAMS, FREE, ONE_METRE), UNIMATE_PARAMS, FREE, one_of(index, 0.36), 8 * SECOND, SUBSTEP_S)
    assert at_end.q[index] == link.travel_high_q
    assert at_end.qd[index] == 0.0
    back = run(at_end, UNIMATE_PARAMS, FREE, one_of(index, -0.36), SECOND // 2, SUBSTEP_S)
    assert back.q[index] < link.travel_high_q


@pytest.mark.parametrize("link", LINKS)
@pytest.mark.parametrize("high", [True, False])
def test_a_stop_holds_what_went_beyond_it_and_leaves_alone_what_stands_at_it(link, high):
    end, outside = (link.travel_high_q, math.inf) if high else (link.travel_low_q, -math.inf)
    at_it = LinkState(end, 0.1, 0.2, 3e6, 4e6)
    beyond = at_it._replace(q=math.nextafter(end, outside))
    assert inside(at_it, link) and not inside(beyond, link)
    assert stopped(at_it, link) == at_it
    assert stopped(beyond, link) == at_it._replace(qd=0.0)
    assert math.isnan(stopped(at_it._replace(q=math.nan), link).q)


@pytest.mark.parametrize("stiffness", [7208.0, 53150.0])
def test_a_tool_driven_into_the_plate_feels_plate_and_gauge_in_series(stiffness):
    contact = plate(stiffness, -0.375)
    pressed = run(machine_start(UNIMATE_PARAMS, contact, ONE_METRE), UNIMATE_PARAMS, contact, (0.0, 0.15, 0.0), 7000, SUBSTEP_S)
    rest = run(pressed, UNIMATE_PARAMS, contact, SHUT, 2 * SECOND, SUBSTEP_S)
    depth_m = -0.375 - tip_position(rest, UNIMATE_PARAMS)[2]
    ks = UNIMATE_PARAMS.sensor_stiffness_n_per_m
    assert rest.qd == SHUT
    assert rest.contact.force_n > 10.0
    assert rest.contact.force_n == pytest.approx(depth_m * stiffness * ks / (stiffness + ks), rel=1e-3)


def pushed_forces(step_s):
    """Contact force over two seconds of pushing the crate at constant current, after one second of getting there."""
    contact = crate(1.01)
    state = machine_start(UNIMATE_PARAMS, contact, ONE_METRE)
    forces = []
    for _ in range(300):
        state = run(state, UNIMATE_PARAMS, contact, (0.0, 0.0, 0.2), round(0.01 / step_s), step_s)
        forces.append(state.contact.force_n)
    assert state.contact.environment_m > 0.05
    return forces[100:]


def test_a_crate_pushed_by_the_boom_slides_at_mu_k_m_g():
    forces = pushed_forces(SUBSTEP_S)
    assert sum(forces) / len(forces) == pytest.approx(0.29 * 64.0 * GRAVITY_M_PER_S2, rel=0.02)


@pytest.mark.parametrize("step_s", [25e-6, 100e-6])
def test_speed_and_force_do_not_depend_on_the_sub_step(step_s):
    forces, fine = pushed_forces(SUBSTEP_S), pushed_forces(step_s)
    assert sum(fine) / len(fine) == pytest.approx(sum(forces) / len(forces), rel=0.01)
    start, current = machine_start(UNIMATE_PARAMS, FREE, ONE_METRE), one_of(1, 0.2)
    speeds = [run(start, UNIMATE_PARAMS, FREE, current, round(1.0 / h), h).qd[1] for h in (SUBSTEP_S, step_s)]
    assert speeds[1] == pytest.approx(speeds[0], rel=0.01)


CONTACTS = [FREE, plate(surface_m=-0.3695), plate(53150.0, -0.3695), crate(1.0005)]


@pytest.mark.parametrize("contact", CONTACTS)
def test_plain_and_compiled_agree_bit_for_bit(contact):
    plain = fast = start = machine_start(UNIMATE_PARAMS, contact, (0.1, 0.0, 0.22))
    forces = {plain.contact.force_n}
    for codes in ((3276, 3276, 2900), (1500, 2800, 3276), (2048, 2048, 2048), (2600, 820, 900)):
        plain = advance(plain, UNIMATE_PARAMS, contact, codes, 300)
        fast = advance_compiled(fast, UNIMATE_PARAMS, contact, codes, 300)
        assert fast == plain
        assert sense_compiled(fast, UNIMATE_PARAMS, contact, 3.3) == sense(plain, UNIMATE_PARAMS, contact, 3.3)
        assert ground_truth_compiled(fast, UNIMATE_PARAMS, contact, 7, -3) == ground_truth(plain, UNIMATE_PARAMS, contact, 7, -3)
        forces.add(plain.contact.force_n)
    assert all(now != then for now, then in zip(plain.q, start.q, strict=True))
    assert len(forces) == (1 if contact is FREE else 5)


odd = st.sampled_from([0.0, -0.0, 1e-300, 1e9, -1e9, 1e300, math.inf, -math.inf, math.nan])
odd_triple = st.tuples(odd, odd, odd)


@settings(max_examples=200, deadline=None)
@given(odd_triple, odd_triple, odd_triple, odd_triple, odd_triple, st.tuples(odd, odd, odd, odd), st.sampled_from(CONTACTS))
def test_no_state_however_odd_raises_or_parts_plain_from_compiled(q, qd, spool, a, b, touch, contact):
    state = MachineState(q, qd, spool, a, b, ContactState(*touch))
    plain = advance(state, UNIMATE_PARAMS, contact, (3276, 820, 2048), 3)
    assert repr(advance_compiled(state, UNIMATE_PARAMS, contact, (3276, 820, 2048), 3)) == repr(plain)
    assert sense_compiled(state, UNIMATE_PARAMS, contact, touch[0]) == sense(state, UNIMATE_PARAMS, contact, touch[0])
    assert repr(ground_truth_compiled(state, UNIMATE_PARAMS, contact, 1, 1)) == repr(
        ground_truth(state, UNIMATE_PARAMS, contact, 1, 1)
    )


def test_the_ground_truth_says_which_link_stands():
    state = machine_start(UNIMATE_PARAMS, FREE, ONE_METRE)
    assert ground_truth(state, UNIMATE_PARAMS, FREE, 1, 2).sticking == (1, 1, 1)
    moving = run(state, UNIMATE_PARAMS, FREE, (0.0, 0.2, 0.0), SECOND // 2, SUBSTEP_S)
    published = ground_truth(moving, UNIMATE_PARAMS, FREE, 1, 2)
    assert published.sticking == (1, 0, 1)
    assert published.tip_m == tip_position(moving, UNIMATE_PARAMS)


def test_positive_current_turns_left_goes_down_and_out():
    start = machine_start(UNIMATE_PARAMS, FREE, ONE_METRE)
    after = advance_compiled(start, UNIMATE_PARAMS, FREE, (2648, 2648, 2648), SECOND)
    assert all(now > before for now, before in zip(after.q, start.q, strict=True))
    assert tip_position(after, UNIMATE_PARAMS)[2] < tip_position(start, UNIMATE_PARAMS)[2]
    assert advance_compiled(start, UNIMATE_PARAMS, FREE, SHUT_CODES, SECOND).q == start.q
