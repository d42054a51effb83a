"""What the tuned gains are set against, and how the evidence explains the ratio."""

import math

import pytest

from hydrohil.services.controller.params import UNIMATE_GAINS
from hydrohil.tuning.bench import Criteria, Step
from hydrohil.tuning.compare import (
    Compared,
    above_least,
    compare,
    reference,
    why_alpha,
    why_braking,
    why_linear,
    why_proportional,
)
from hydrohil.tuning.procedure import LinkTuning
from tests.support.tuning_scene import EXPERIMENT, GAINS


def step(rows):
    return Step(number=1, title="", rule="", columns=(), rows=tuple(rows), decision="", gains=None)


def test_the_unimate_is_set_against_table_2_whatever_gains_the_experiment_has():
    other = (GAINS, GAINS, GAINS)
    assert reference(EXPERIMENT.plant, other) == ("Table 2", UNIMATE_GAINS)


def test_another_plant_is_set_against_the_experiments_own_gains():
    machine = EXPERIMENT.plant.machine._replace(boom_mass_kg=50.0)
    assert reference(EXPERIMENT.plant._replace(machine=machine), (GAINS, GAINS, GAINS)) == ("before", (GAINS, GAINS, GAINS))


def test_a_link_without_gains_has_nothing_to_compare():
    assert compare(LinkTuning(1, (), None, ()), "Table 2", GAINS, Criteria()) == ()


def test_a_ratio_to_nothing_is_no_number():
    assert Compared("K_a", "", 1.0, 2.0, "").ratio == 0.5
    assert math.isnan(Compared("K_a", "", 1.0, 0.0, "").ratio)


def test_the_margin_of_either_gain_is_stated():
    rows = [(100.0, 0.3, 0.3, 0.0, 1.0, "yes"), (240.0, 0.3, 0.3, 0.0, 1.0, "yes"), (250.0, 1.0, 2.0, 0.0, 1.0, "no")]
    assert "stays 1.20 below it, this rule 1.5" in why_proportional(step(rows), 200.0, "Table 2", Criteria(margin=1.5))


def test_evidence_is_read_between_its_rows_and_not_beyond_them():
    rows = [(100.0, 0.2, "yes"), (200.0, 0.4, "no")]
    assert "30%" in why_linear(step(rows), 150.0, "Table 2", 1)
    assert "not reached" in why_linear(step(rows), 201.0, "Table 2", 1)
    assert "a tenth of K_I" in why_linear(step(rows), 150.0, "Table 2", 0)


@pytest.mark.parametrize(("ratio", "sharp"), [(1.15, False), (1.16, True)])
def test_an_optimum_is_called_sharp_only_where_the_error_shows_it(ratio, sharp):
    assert ("no sharp optimum" not in above_least(ratio)) == sharp


def test_the_cost_of_the_other_value_is_stated():
    alphas = [(1.0, 0.4, "yes"), (2.0, 0.2, "yes"), (4.0, 0.1, "no")]
    assert "100% above" in why_alpha(step(alphas), 1.0, "Table 2")
    assert "outside" in why_alpha(step(alphas), 5.0, "Table 2")
    braked = [(0.0, 1.0, 1.0, 1.0), (10.0, 1.0, 1.0, 0.5)]
    assert "50% above" in why_braking(step(braked), 5.0, "Table 2")
    assert "outside" in why_braking(step(braked), 11.0, "Table 2")
