import pytest

from hydrohil.experiment.experiment import to_plain, warnings
from hydrohil.services.controller.config import ControllerConfig, ImpedanceConfig
from hydrohil.services.controller.contact_environment import ContactEnvironment, contact_environment
from hydrohil.services.controller.preflight import preflight
from hydrohil.thesis.library import find

PLATE = ContactEnvironment("plate", 6231.0, 2, 1.0, 0.0)
FREE = ContactEnvironment("free", 0.0, 2, 1.0, 0.0)


def target(stiffness, estimate=6200.0, **fields):
    return ControllerConfig(impedance=ImpedanceConfig(500.0, stiffness, 1.2, "net", estimate), **fields)


def test_a_target_that_must_cycle_is_named_with_its_numbers_in_one_line():
    (line,) = preflight(target(50.0), PLATE)
    assert "\n" not in line
    assert all(words in line for words in ("50 N/m", "must limit-cycle", "6200 N/m", "6231 N/m", "12462 N/m", "thesis 7.1"))


def test_one_that_may_is_reported_and_one_that_cannot_is_not():
    assert "may limit-cycle" in preflight(target(5e3), PLATE)[0]
    assert preflight(target(12462.0), PLATE) == ()
    assert preflight(target(12461.9), PLATE) != ()


@pytest.mark.parametrize(("estimate", "says"), [(25e3, "as estimated: must, 6231 N/m in truth: may"), (0.0, "cannot, 6231")])
def test_estimate_and_ground_truth_are_judged_apart_and_the_worse_one_counts(estimate, says):
    (line,) = preflight(target(10e3, estimate), PLATE)
    assert says in line


def test_nothing_is_reported_where_no_target_meets_an_environment():
    assert preflight(target(50.0), FREE) == ()
    assert preflight(target(50.0, target="cartesian"), PLATE) == ()


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("fig-7-1", "must"),
        ("fig-7-2", "must"),
        ("fig-7-3", "may"),
        ("fig-7-4", ""),
        ("fig-7-5", "must"),
        ("fig-7-6", ""),
        ("fig-5-2", ""),
        ("fig-5-5", ""),
    ],
)
def test_the_trials_of_the_thesis_are_distinguished(name, words):
    experiment = find(name)
    lines = warnings(experiment)
    assert lines == preflight(experiment.controller, contact_environment(to_plain(experiment.plant)))
    assert [f" {words} limit-cycle" in line for line in lines] == ([True] if words else [])
