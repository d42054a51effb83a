import numpy as np
import pytest

from hydrohil.services.controller.config import impedance_params
from hydrohil.thesis.claims6 import FIGURES, STEP_N
from hydrohil.thesis.library import find, pairs

K_EFF = 6200.0


@pytest.mark.parametrize("k", FIGURES)
def test_both_controllers_meet_the_same_machine_target_and_step(k):
    impedance, explicit, _ = FIGURES[k]
    one, other = find(f"fig-{impedance}"), find(f"fig-{explicit}")
    assert one.plant == other.plant
    assert one.reference == other.reference
    assert one.controller == other.controller._replace(target="impedance")
    assert (one.controller.acting, one.controller.law) == ((False, True, False), "pi")
    assert one.controller.impedance.stiffness_n_per_m == k


@pytest.mark.parametrize("k", FIGURES)
def test_the_stated_levels_are_what_model_and_environment_share(k):
    assert STEP_N * K_EFF / (k + K_EFF) == pytest.approx(FIGURES[k][2], abs=1.0)


@pytest.mark.parametrize("k", FIGURES)
def test_the_trials_last_until_the_force_has_settled_to_a_hundredth(k):
    experiment = find(f"fig-{FIGURES[k][0]}")
    target = impedance_params(experiment.controller.impedance, 2, 1.0)
    c = 2.0 * target.damping_ratio * target.natural_frequency_rad_per_s * 500.0
    slow = np.max(np.roots([500.0, c, k + K_EFF]).real)
    remaining_s = 10.0 - experiment.reference[0].start_s
    assert np.exp(slow * remaining_s) < 0.01


def test_every_pair_has_the_seven_statements_and_the_levels_fall_with_the_stiffness():
    named = [(claim.of, claim.against) for claim in pairs() if claim.of.startswith("fig-6-")]
    for impedance, explicit, _ in FIGURES.values():
        assert named.count((f"fig-{explicit}", f"fig-{impedance}")) == 7
    assert {("fig-6-8", "fig-6-6"), ("fig-6-10", "fig-6-8"), ("fig-6-9", "fig-6-7"), ("fig-6-11", "fig-6-9")} <= set(named)


def test_the_formulations_differ_in_nothing_else():
    alternate, proposed = find("alternate-k50000"), find("proposed-k50000")
    assert alternate.plant == proposed.plant
    assert alternate.controller.impedance._replace(formulation="setpoint") == proposed.controller.impedance
    assert alternate.controller.impedance.stiffness_n_per_m > 2.0 * K_EFF


def test_in_free_space_nothing_touches_and_nothing_is_asked():
    standing, touching = find("alternate-free-space"), find("alternate-k500")
    assert standing.plant.environment.kind == "free"
    assert standing.reference == ()
    assert standing.controller == touching.controller
