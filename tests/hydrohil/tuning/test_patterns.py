"""The patterns of chapter 4 on any link."""

import pytest

from hydrohil.experiment.experiment import checked
from hydrohil.services.controller.config import AdaptationConfig
from hydrohil.services.plant.params import Environment
from hydrohil.shared.units import RAD_PER_DEG
from hydrohil.thesis.chapter4 import PATTERNS, TRAJECTORIES
from hydrohil.thesis.library import catalogue, find
from hydrohil.tuning.patterns import middle_q, pattern, trial

EXPERIMENT = find("fig-4-25")
GAINS = EXPERIMENT.controller.gains


@pytest.mark.parametrize("name", PATTERNS)
def test_link_2_gets_the_very_patterns_of_chapter_4(name):
    scaled = pattern(name, 1, GAINS[1])
    for segment, printed in zip(scaled.reference, TRAJECTORIES[name].reference, strict=True):
        assert segment._replace(amount=0.0) == printed._replace(amount=0.0)
        assert segment.amount == pytest.approx(printed.amount)
    assert scaled.start_q == pytest.approx(TRAJECTORIES[name].start_deg * RAD_PER_DEG)


def test_the_large_ramp_of_every_link_runs_at_its_fastest_set_speed():
    for link, gains in enumerate(GAINS):
        first = pattern("large-ramp", link, gains).reference[0]
        assert first.amount / (first.duration_s - first.blend_s) == pytest.approx(gains.qd_max_q_per_s)
        assert first.channel == f"q{link + 1}"


@pytest.mark.parametrize("link", [0, 1, 2])
@pytest.mark.parametrize("name", PATTERNS)
def test_every_pattern_stays_within_the_travel_of_every_link(link, name):
    middle = middle_q(EXPERIMENT, link, GAINS[link])
    checked(trial(EXPERIMENT, link, "final", GAINS[link], pattern(name, link, GAINS[link]), middle), "test")


def test_constant_speed_lies_between_the_blends():
    scaled = pattern("large-ramp", 1, GAINS[1])
    for (start, end), ramp in zip(scaled.cruises_s, scaled.reference, strict=True):
        assert ramp.start_s + ramp.blend_s < start < end <= ramp.start_s + ramp.duration_s - ramp.blend_s


def test_a_trial_is_free_and_isolated_whatever_the_experiment_does():
    busy = find("fig-5-5")._replace(claims=find("fig-5-5").claims)
    controller = busy.controller._replace(adaptation=AdaptationConfig("stiffness"))
    busy = busy._replace(controller=controller)
    scaled = checked(trial(busy, 2, "pi", GAINS[2], pattern("small-step", 2, GAINS[2]), 0.5), "test")
    assert scaled.plant.environment == Environment()
    assert scaled.controller.acting == (False, False, True)
    assert (scaled.controller.target, scaled.claims) == ("joint", ())
    assert scaled.plant.machine == busy.plant.machine and scaled.supervisor == busy.supervisor


def test_the_place_keeps_as_much_again_as_the_pattern_from_the_limits():
    tight = EXPERIMENT._replace(
        supervisor=EXPERIMENT.supervisor._replace(joint_low_q=EXPERIMENT.supervisor.joint_low_q._replace(down_up=-0.3))
    )
    assert middle_q(tight, 1, GAINS[1]) == pytest.approx(-0.3 + 20.0 * RAD_PER_DEG)
    assert middle_q(EXPERIMENT, 1, GAINS[1]) == EXPERIMENT.plant.initial_q[1]
    assert middle_q(EXPERIMENT, 2, GAINS[2]) == pytest.approx(EXPERIMENT.supervisor.joint_low_q[2] + 0.4)


@pytest.mark.parametrize("experiment", catalogue(), ids=lambda experiment: experiment.alias)
def test_the_plant_of_every_experiment_can_be_tuned(experiment):
    gains = experiment.controller.gains[1]
    checked(trial(experiment, 1, "final", gains, pattern("small-step", 1, gains), middle_q(experiment, 1, gains)), "test")
