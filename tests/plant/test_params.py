import math

import pytest
from pydantic import TypeAdapter, ValidationError

from hydrohil.services.plant.params import (
    AXIS_X,
    AXIS_Z,
    UNIMATE_PARAMS,
    ContactParams,
    Environment,
    MachineParams,
    contact_params,
)

MACHINE = TypeAdapter(MachineParams)
ENVIRONMENT = TypeAdapter(Environment)


def as_dict(machine: MachineParams) -> dict[str, object]:
    return {name: part._asdict() if hasattr(part, "_asdict") else part for name, part in machine._asdict().items()}


def test_the_unimate_is_within_its_own_bounds():
    assert MACHINE.validate_python(as_dict(UNIMATE_PARAMS)) == UNIMATE_PARAMS


@pytest.mark.parametrize("supply_pa", [1e5, 6.5e6, 21e6, 35e6])
def test_the_supply_may_be_that_of_any_hydraulic_arm(supply_pa):
    assert MACHINE.validate_python(as_dict(UNIMATE_PARAMS) | {"supply_pressure_pa": supply_pa}).supply_pressure_pa == supply_pa


@pytest.mark.parametrize("supply_pa", [0.0, -7e6, 35.001e6, math.nan, math.inf])
def test_a_supply_that_no_hydraulic_arm_has_is_refused(supply_pa):
    with pytest.raises(ValidationError):
        MACHINE.validate_python(as_dict(UNIMATE_PARAMS) | {"supply_pressure_pa": supply_pa})


@pytest.mark.parametrize("name", ["displacement_m3_per_q", "dead_volume_m3", "valve_lag_s", "stribeck_q_per_s"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_what_a_sub_step_divides_by_must_be_positive_and_finite(name, value):
    with pytest.raises(ValidationError):
        MACHINE.validate_python(as_dict(UNIMATE_PARAMS) | {"down_up": UNIMATE_PARAMS.down_up._asdict() | {name: value}})


@pytest.mark.parametrize("ratio", [0.0, 0.0999, 10.001, -1.0, math.nan, math.inf])
def test_piston_areas_further_apart_than_ten_to_one_are_refused(ratio):
    with pytest.raises(ValidationError):
        MACHINE.validate_python(as_dict(UNIMATE_PARAMS) | {"out_in": UNIMATE_PARAMS.out_in._asdict() | {"area_ratio": ratio}})


@pytest.mark.parametrize("stiffness", [0.0, -1.0, math.nan, math.inf])
def test_a_plate_needs_a_positive_finite_stiffness(stiffness):
    with pytest.raises(ValidationError):
        ENVIRONMENT.validate_python({"kind": "plate", "stiffness_n_per_m": stiffness})


def test_an_unknown_environment_is_refused():
    with pytest.raises(ValidationError):
        ENVIRONMENT.validate_python({"kind": "wall"})


def direction(contact: ContactParams) -> tuple[int, float]:
    return contact.force_axis, contact.force_sign


def test_the_plate_pushes_up_and_the_crate_pushes_back():
    assert direction(contact_params(Environment("free"))) == (AXIS_Z, 1.0)
    assert direction(contact_params(Environment("plate"))) == (AXIS_Z, 1.0)
    assert direction(contact_params(Environment("crate"))) == (AXIS_X, -1.0)


def test_the_crate_of_the_thesis_slides_at_182_n():
    contact = contact_params(Environment("crate"))
    assert contact.sliding_n == pytest.approx(182.1, abs=0.1)
    assert contact.breakaway_n == pytest.approx(232.3, abs=0.1)


def test_a_crate_may_stick_as_much_as_it_slides_but_not_less():
    contact = contact_params(Environment("crate", crate_static_friction=0.29))
    assert contact.breakaway_n == contact.sliding_n
    with pytest.raises(ValueError, match=r"crate_static_friction is 0\.28"):
        contact_params(Environment("crate", crate_static_friction=0.28))
