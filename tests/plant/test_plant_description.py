"""What a plant says of itself: the machine that its configuration names, as it is configured, or why that cannot be."""

import math

import pytest

from hydrohil.services.plant.config import GateLimits, PlantConfig
from hydrohil.services.plant.params import Environment
from hydrohil.services.plant.plant_description import describe, machine_description
from hydrohil.shared.contract.description import description_problem
from hydrohil.shared.machine.unimate import UNIMATE

PLANT = PlantConfig()


def changed(**values: object) -> PlantConfig:
    return PLANT._replace(machine=PLANT.machine._replace(**values))


def test_the_machine_that_ships_describes_itself_as_it_stands_in_its_file():
    assert machine_description(PLANT) == UNIMATE


def test_a_configured_length_is_described_and_changes_the_hash():
    described, other = (describe(plant, GateLimits()) for plant in (PLANT, changed(a4_m=0.7)))
    assert other.machine.geometry == UNIMATE.geometry._replace(hand_m=0.7)
    assert other.machine_hash != described.machine_hash
    assert description_problem(other) == ""


def test_a_configured_travel_and_gauge_are_described():
    out_in = PLANT.machine.out_in._replace(travel_high_q=0.9)
    machine = machine_description(changed(out_in=out_in, sensor_stiffness_n_per_m=5e4, force_high_n=900.0))
    assert machine.geometry.high_q == (*UNIMATE.geometry.high_q[:2], 0.9)
    assert (machine.gauge.stiffness_n_per_m, machine.gauge.range_n) == (5e4, 900.0)


@pytest.mark.parametrize(("configured_n", "described_n"), [(0.0, 10.0), (10.0, 10.0), (25.0, 25.0)])
def test_a_gauge_is_never_described_as_quieter_than_the_machine_s_is_known_to_be(configured_n, described_n):
    assert machine_description(changed(force_noise_clip_n=configured_n)).gauge.noise_n == described_n


def test_whole_numbers_are_described_as_floats_so_that_they_pass_the_wire():
    assert type(machine_description(changed(a4_m=1)).geometry.hand_m) is float


def test_an_unknown_machine_is_refused_with_the_names_that_there_are():
    with pytest.raises(ValueError, match=r"plant.machine_name is 'puma'; expected one of unimate"):
        describe(PLANT._replace(machine_name="puma"), GateLimits())


@pytest.mark.parametrize("supply_pa", [6.5e6, 7.5e6])
def test_the_unimate_s_supply_may_be_at_either_end_of_its_band(supply_pa):
    assert machine_description(changed(supply_pressure_pa=supply_pa)) == UNIMATE


@pytest.mark.parametrize("supply_pa", [6.499e6, 7.501e6, 21e6, math.nan])
def test_a_supply_outside_the_unimate_s_band_is_refused(supply_pa):
    with pytest.raises(ValueError, match=r"supply_pressure_pa is \S+ MPa; expected 6.5..7.5 MPa of the machine unimate"):
        describe(changed(supply_pressure_pa=supply_pa), GateLimits())


def test_a_start_outside_the_configured_travel_is_refused():
    short = PLANT.machine.out_in._replace(travel_high_q=0.2)
    with pytest.raises(ValueError, match=r"plant.initial_q.out_in is 0.212 m; expected inside its travel, 0..0.2"):
        describe(changed(out_in=short), GateLimits())


def test_a_machine_that_no_description_can_state_is_refused_by_the_plant_itself():
    with pytest.raises(ValueError, match=r"plant: machine.geometry.hand_m is 1000 m; expected -100..100; correct the machine"):
        describe(changed(a4_m=1e3), GateLimits())


@pytest.mark.parametrize(("kind", "axis", "sign"), [("free", 2, 1.0), ("plate", 2, 1.0), ("crate", 0, -1.0)])
def test_the_direction_of_the_gauge_is_that_of_the_environment(kind, axis, sign):
    described = describe(PLANT._replace(environment=Environment(kind)), GateLimits())
    assert (described.force_axis, described.force_sign) == (axis, sign)


@pytest.mark.parametrize(
    ("field", "most"), [("sensor_stiffness_n_per_m", 92_000.0), ("sensor_damping_ns_per_m", 1200.0), ("force_high_n", 1400.0)]
)
def test_no_experiment_widens_the_rules_on_force_beyond_twice_the_machine_s_own_gauge(field, most):
    machine_description(changed(**{field: most}))
    for value in (most * 1.001, 1e8, math.inf, math.nan):
        with pytest.raises(ValueError, match=rf"plant.machine.{field} is \S+ N.*; expected at most {most:g}"):
            machine_description(changed(**{field: value}))
