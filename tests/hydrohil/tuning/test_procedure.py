"""The procedure as a whole: it knows a rig by its trials alone, ends where a step finds nothing, and follows the plant."""

import ast
from pathlib import Path

import pytest

import hydrohil.tuning
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.overrides import with_overrides
from hydrohil.experiment.sections import Gains
from hydrohil.simulation.rollout import rollout
from hydrohil.tuning.linear import proportional
from hydrohil.tuning.procedure import STEPS, tune_link, worth
from tests.hydrohil.claims.test_trace import standing
from tests.support.tuning_scene import EXPERIMENT, GAINS, LINK, bench, stuck_until

SOURCES = sorted(Path(hydrohil.tuning.__file__).parent.glob("*.py"))


def imported(path):
    nodes = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.ImportFrom)]
    return {node.module for node in nodes}


def test_the_procedure_sees_no_emulator_only_trials():
    assert len(SOURCES) > 5
    modules = set().union(*(imported(path) for path in SOURCES if path.name != "tune.py"))  # which plays the trials
    assert "hydrohil.experiment.sections" in modules
    assert not [name for name in modules if name.startswith(("hydrohil.simulation", "hydrohil.services"))]


def test_the_plants_parameters_decide_nothing_but_what_the_gains_are_set_against():
    readers = [path.name for path in SOURCES if "plant.machine" in path.read_text()]
    assert readers == ["compare.py"]


def test_the_steps_end_with_the_first_that_finds_nothing_and_each_is_reported():
    calls = []
    tuned = tune_link(bench(stuck_until(float("inf"), float("inf"))), lambda link, step: calls.append((link, step.number)))
    assert calls == [(LINK, 1)]
    assert tuned.gains is None and tuned.worth == ()
    assert [step.number for step in tuned.steps] == [1] and STEPS == 6


def test_every_seed_is_played_and_one_that_trips_is_noticed():
    seeds = []

    def run(experiment: Experiment, seed: int):
        seeds.append(seed)
        return standing(1.0 if seed == 2 else experiment.duration_s)

    worth(bench(run, seeds=3), GAINS)
    assert set(seeds) == {0, 1, 2}


def largest_gain(*settings):
    changed = bench(rollout)._replace(experiment=with_overrides(EXPERIMENT, settings))
    return proportional(changed, GAINS).gains.kp_a_per_q


def test_the_proportional_gain_follows_stiffness_and_flow_of_the_plant():
    normal = largest_gain()
    stiffer = largest_gain("plant.machine.down_up.bulk_modulus_pa=6.4e8")
    faster = largest_gain("plant.machine.down_up.flow_gain_m3_per_s_sqrt_pa=7.6e-7")
    assert stiffer > 1.2 * normal > 1.2 * 1.2 * faster


def test_patterns_that_leave_the_travel_are_refused_before_any_trial():
    wide = EXPERIMENT._replace(
        controller=EXPERIMENT.controller._replace(gains=Gains(GAINS, GAINS._replace(qd_max_q_per_s=2.0), GAINS))
    )
    with pytest.raises(ValueError, match="leaves the travel"):
        tune_link(bench(None)._replace(experiment=wide))
