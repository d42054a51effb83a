import math

import pytest

from hydrohil.services.plant.contact import ContactState, contact_start, contact_step
from hydrohil.services.plant.params import UNIMATE_PARAMS, Environment, contact_params
from hydrohil.shared.units import GRAVITY_M_PER_S2, SUBSTEP_S

UNTOUCHED = ContactState(0.0, 0.0, 0.0, 0.0)
SENSOR = UNIMATE_PARAMS.sensor_stiffness_n_per_m
SOFT, STIFF = 7208.0, 53150.0


def plate(stiffness):
    return contact_params(Environment("plate", stiffness_n_per_m=stiffness, surface_m=-0.4))


CRATE = contact_params(Environment("crate", surface_m=1.0))


def hold(contact, tip_m, seconds, state=UNTOUCHED):
    for _ in range(round(seconds / SUBSTEP_S)):
        state = contact_step(state, contact, UNIMATE_PARAMS, tip_m, SUBSTEP_S)
    return state


def over_plate(depth_m):
    return 1.0, 0.0, -0.4 - depth_m


@pytest.mark.parametrize("stiffness", [500.0, SOFT, STIFF, 1e9])
def test_plate_and_gauge_settle_as_springs_in_series(stiffness):
    state = hold(plate(stiffness), over_plate(0.005), 1.0)
    assert state.force_n == pytest.approx(0.005 * stiffness * SENSOR / (stiffness + SENSOR), rel=1e-6)
    assert state.gauge_m * SENSOR == pytest.approx(state.force_n, rel=1e-6)
    assert state.environment_m + state.gauge_m == pytest.approx(0.005)


@pytest.mark.parametrize("contact", [plate(SOFT), plate(STIFF), CRATE])
def test_contact_at_rest_stays_as_it_starts(contact):
    tip_m = (1.004, 0.0, -0.404)
    start = contact_start(contact, UNIMATE_PARAMS, tip_m)
    assert start.force_n > 0.0
    assert hold(contact, tip_m, 0.1, start) == pytest.approx(start, rel=1e-9)


@pytest.mark.parametrize("contact", [plate(SOFT), CRATE])
def test_contact_begins_just_past_the_surface(contact):
    assert hold(contact, (1.0, 0.0, -0.4), 0.01) == UNTOUCHED
    assert hold(contact, (1.0 + 1e-9, 0.0, -0.4 - 1e-9), 0.01).force_n > 0.0


def test_free_space_never_pushes_and_lets_go_of_what_was_pressed():
    free = contact_params(Environment("free"))
    assert hold(free, (9.0, 9.0, -9.0), 0.01) == UNTOUCHED
    assert hold(free, (9.0, 9.0, -9.0), 0.01, ContactState(0.01, 0.01, 0.1, 100.0)) == UNTOUCHED


@pytest.mark.parametrize("contact", [plate(STIFF), CRATE])
def test_a_tool_snatched_away_is_let_go_and_its_gauge_relaxes_by_itself(contact):
    pressed = contact_start(contact, UNIMATE_PARAMS, (1.004, 0.0, -0.404))
    lag_s = UNIMATE_PARAMS.sensor_damping_ns_per_m / SENSOR
    state = hold(contact, (0.9, 0.0, -0.3), lag_s, pressed)
    assert state.force_n == 0.0
    assert state.gauge_m == pytest.approx(pressed.gauge_m * math.exp(-1), rel=0.01)


@pytest.mark.parametrize("speed_m_per_s", [0.001, 0.05, 1.0])
@pytest.mark.parametrize("contact", [plate(SOFT), plate(STIFF), CRATE])
def test_no_tool_is_ever_pulled_however_it_leaves(contact, speed_m_per_s):
    state = contact_start(contact, UNIMATE_PARAMS, (1.001, 0.0, -0.401))
    forces = []
    for step in range(round(0.003 / speed_m_per_s / SUBSTEP_S)):
        back_m = speed_m_per_s * step * SUBSTEP_S
        state = contact_step(state, contact, UNIMATE_PARAMS, (1.001 - back_m, 0.0, -0.401 + back_m), SUBSTEP_S)
        forces.append(state.force_n)
    assert min(forces) == 0.0 == forces[-1]
    assert max(forces) > 1.0


def test_a_plate_hit_at_speed_shows_no_step_of_force():
    """The damper sits beside the gauge's spring, in series with the plate: force grows from zero."""
    first = contact_step(UNTOUCHED, plate(SOFT), UNIMATE_PARAMS, over_plate(0.5 * SUBSTEP_S), SUBSTEP_S)
    assert first.force_n < SOFT * 0.5 * SUBSTEP_S


def test_the_crate_stands_until_break_away_and_slides_just_past_it():
    breakaway_m = CRATE.breakaway_n / SENSOR
    for depth_m, stands in ((breakaway_m * 0.9999, True), (breakaway_m * 1.0001, False)):
        start = ContactState(depth_m, 0.0, 0.0, 0.0)
        assert (contact_step(start, CRATE, UNIMATE_PARAMS, (1.0 + depth_m, 0.0, 0.0), SUBSTEP_S).environment_m == 0.0) is stands


def test_a_crate_pushed_steadily_pushes_back_with_mu_k_m_g():
    state, x_m, forces = UNTOUCHED, 1.0, []
    for _ in range(60_000):
        x_m += 0.10 * SUBSTEP_S
        state = contact_step(state, CRATE, UNIMATE_PARAMS, (x_m, 0.0, 0.0), SUBSTEP_S)
        forces.append(state.force_n)
    assert forces[-1] == pytest.approx(0.29 * 64.0 * GRAVITY_M_PER_S2, rel=1e-3)
    assert max(forces) > CRATE.breakaway_n  # it had to be broken away


def test_a_crate_given_a_shove_slides_until_friction_has_taken_its_energy():
    state = hold(CRATE, (0.5, 0.0, 0.0), 1.0, ContactState(0.0, 0.0, 0.3, 0.0))
    assert state.environment_m_per_s == 0.0
    assert state.environment_m == pytest.approx(0.3 * 0.3 / (2 * 0.29 * GRAVITY_M_PER_S2), rel=1e-3)
