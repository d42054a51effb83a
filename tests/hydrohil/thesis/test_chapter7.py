import pytest

from hydrohil.services.controller.config import impedance_params
from hydrohil.thesis.library import find

CAPTIONS = {  # mass, stiffness, xi_net
    "fig-7-1": (500.0, 50.0, 5.0),
    "fig-7-2": (500.0, 500.0, 5.0),
    "fig-7-3": (500.0, 5e3, 2.0),
    "fig-7-4": (500.0, 50e3, 0.3),
    "fig-7-5": (50e3, 50.0, 1.2),
    "fig-7-6": (50.0, 50e3, 1.2),
}
K_EFF_N_PER_M = 7208.0 * 46e3 / (7208.0 + 46e3)


@pytest.mark.parametrize("name", CAPTIONS)
def test_each_trial_has_the_target_of_its_caption_and_no_compensation(name):
    impedance = find(name).controller.impedance
    assert (impedance.mass_kg, impedance.stiffness_n_per_m, impedance.damping_ratio, impedance.damping) == (
        *CAPTIONS[name],
        "net",
    )
    assert impedance_params(impedance, 2, 1.0).force_gain == 1.0
    assert find(name).controller.law == "final"
    assert find(name).controller.acting == (False, True, False)


def test_damping_is_over_critical_below_the_environments_stiffness_and_under_it_at_the_first_stiffness_above():
    for name in ("fig-7-1", "fig-7-2", "fig-7-3", "fig-7-4"):
        impedance = find(name).controller.impedance
        assert (impedance.damping_ratio > 1.0) is (impedance.stiffness_n_per_m < K_EFF_N_PER_M)


def test_all_trials_differ_in_their_target_alone():
    first = find("fig-7-1")
    for name in CAPTIONS:
        trial = find(name)
        assert (trial.plant, trial.reference, trial.duration_s) == (first.plant, first.reference, first.duration_s)
        assert trial.controller._replace(impedance=first.controller.impedance) == first.controller
