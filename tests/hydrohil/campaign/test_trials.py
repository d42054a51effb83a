"""Trials by their number: every combination once, the same draws at every point, each runnable alone."""

import shlex
from itertools import pairwise
from typing import Any

import pytest

from hydrohil.campaign.trials import command, count, experiment_of, points, trial_of, validate
from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.overrides import with_overrides
from hydrohil.thesis.library import find
from tests.support.campaign_scene import plan, table

DAMPING = "controller.impedance.damping_ratio"


def test_every_point_comes_with_every_repeat_exactly_once():
    campaign = plan().campaign
    trials = [trial_of(campaign, number) for number in range(count(campaign))]
    assert (points(campaign), len(trials)) == (6, 12)
    combinations = {(t.parameters["controller.law"], t.parameters["mass_kg"], t.repeat) for t in trials}
    assert len(combinations) == 12
    assert [(t.point, t.repeat, t.seed) for t in trials[:3]] == [(0, 0, 5), (0, 1, 6), (1, 0, 5)]


def test_every_point_meets_the_same_draws_and_seeds():
    campaign = plan().campaign
    trials = [trial_of(campaign, number) for number in range(count(campaign))]
    for repeat in range(2):
        assert len({(t.seed, t.parameters[DAMPING]) for t in trials if t.repeat == repeat}) == 1


def test_another_axis_or_metric_leaves_the_draws_as_they_are():
    more = {"controller.impedance.stiffness_n_per_m": {"lognormal": {"median": 50e3, "sigma": 0.1}}, **table()["sweep"]}
    assert trial_of(plan(sweep=more).campaign, 3).parameters[DAMPING] == trial_of(plan().campaign, 3).parameters[DAMPING]


def test_a_formula_decides_the_fields_that_it_names():
    mass = {"natural": {"list": [2.0, 4.0], "sets": {"controller.impedance.mass_kg": "50e3 / value ** 2", "duration_s": "value"}}}
    one = plan(sweep=mass)
    experiment = experiment_of(one, trial_of(one.campaign, count(one.campaign) - 1).parameters)
    assert (experiment.controller.impedance.mass_kg, experiment.duration_s) == (3125.0, 4.0)


@pytest.mark.parametrize("number", [-1, 12])
def test_there_is_no_trial_beyond_the_ends(number: int):
    with pytest.raises(IndexError, match="0 to 11"):
        trial_of(plan().campaign, number)


def test_the_printed_command_makes_the_same_experiment():
    one = plan()
    trial = trial_of(one.campaign, 9)
    words = shlex.split(command(one, trial))
    assert words[:3] == ["hydrohil", "run", "fig-5-5"]
    settings = [value for flag, value in pairwise(words) if flag == "--set"]
    assert with_overrides(find("fig-5-5"), settings) == experiment_of(one, trial.parameters)
    assert words[words.index("--seed") + 1] == str(trial.seed)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"sweep": {"controller.lw": {"list": ["pi"]}}}, "lw is no field of controller"),
        ({"sweep": {"controller.law": {"list": ["pi", "pid"]}}}, "pid"),
        ({"sweep": {DAMPING: {"grid": {"from": 1.0, "to": 101.0, "count": 3}}}}, "less than or equal to 100"),
        ({"sweep": {DAMPING: {"normal": {"mean": 0.0, "deviation": 1.0}}}, "repeats": 20}, "greater than or equal to 0"),
        ({"sweep": {"a": {"list": [0.0], "sets": {DAMPING: "1 / value"}}}}, "sweep.a.sets"),
        (
            {"set": {"faults": [{"kind": "loss", "target": "plant>controller", "at_s": 0.0, "lasts_s": 1.0, "value": 0.1}]}},
            "local clock",
        ),
        ({"sweep": {"duration_s": {"list": [0.1, 0.05]}}}, "metrics.peak_n.end_s"),
    ],
)
def test_what_a_corner_refuses_is_reported_before_anything_runs(changes: dict[str, Any], words: str):
    with pytest.raises(ExperimentError, match=words) as caught:
        validate(plan(**changes))
    assert "first at" in str(caught.value)


def test_a_value_on_its_bound_is_accepted_and_the_longest_trial_is_found():
    ends = {DAMPING: {"grid": {"from": 0.0, "to": 100.0, "count": 3}}, "duration_s": {"list": [0.1, 0.3, 0.2]}}
    assert validate(plan(sweep=ends)).duration_s == 0.3
