import pytest
from scipy.optimize import brentq

from hydrohil.experiment.experiment import to_plain
from hydrohil.services.controller.contact_environment import contact_environment, resting_m
from hydrohil.services.plant.config import PlantConfig
from hydrohil.services.plant.params import UNIMATE_PARAMS, Environment, contact_params


def met(kind, surface_m=0.0, stiffness=7208.0):
    return contact_environment(
        to_plain(PlantConfig(environment=Environment(kind, stiffness_n_per_m=stiffness, surface_m=surface_m)))
    )


@pytest.mark.parametrize("kind", ["free", "plate", "crate"])
def test_axis_and_direction_are_the_plants_own(kind):
    contact = contact_params(Environment(kind))
    assert (met(kind).force_axis, met(kind).force_sign) == (contact.force_axis, contact.force_sign)


def test_plate_and_gauge_are_springs_in_series_and_a_standing_crate_leaves_the_gauge_alone():
    gauge = UNIMATE_PARAMS.sensor_stiffness_n_per_m
    assert 1.0 / met("plate").stiffness_n_per_m == pytest.approx(1.0 / 7208.0 + 1.0 / gauge)
    assert met("crate").stiffness_n_per_m == gauge
    assert met("free").stiffness_n_per_m == 0.0


def test_what_is_no_section_of_a_plant_is_refused():
    with pytest.raises(KeyError, match="environment"):
        contact_environment({})


def test_in_free_space_the_tool_goes_down_by_the_springs_deflection():
    assert resting_m(met("free"), 0.0, 0.1, 100.0, 500.0) == pytest.approx(0.1 - 0.2)


def test_against_a_crate_it_goes_forward():
    assert resting_m(met("crate"), 0.0, 0.1, 100.0, 500.0) == pytest.approx(0.1 + 0.2)


@pytest.mark.parametrize("surface_m", [-0.5, -0.05, 0.0, 0.002])
@pytest.mark.parametrize("push_n", [-50.0, 0.0, 100.0, 300.0])
@pytest.mark.parametrize("nominal_m", [-0.1, 0.0, 0.03])
def test_on_a_plate_target_and_springs_are_in_balance(surface_m, push_n, nominal_m):
    plate = met("plate", surface_m)
    k, start_m = 800.0, 0.0

    def force_n(x_m):
        return plate.stiffness_n_per_m * max(0.0, surface_m - x_m)

    def imbalance_n(x_m):
        return k * (x_m - nominal_m) - (force_n(x_m) - force_n(start_m)) + push_n

    expected = brentq(imbalance_n, -5.0, 5.0, xtol=1e-12)
    assert resting_m(plate, start_m, nominal_m, push_n, k) == pytest.approx(expected, abs=1e-9)
