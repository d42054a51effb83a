import numpy as np
import pytest

from hydrohil.services.controller.config import impedance_params, segment_table
from hydrohil.services.controller.reference import reference_deltas
from hydrohil.thesis import chapter5
from hydrohil.thesis.library import find


def reference(name):
    """Times and all channels of the reference, 100 a second."""
    experiment = find(name)
    table, times = segment_table(experiment.reference), np.arange(0.0, experiment.duration_s, 0.01)
    return times, np.array([reference_deltas(table, t) for t in times])


def series(soft):
    plate = 7208.0 if soft else 53150.0
    return plate * 46e3 / (plate + 46e3)


@pytest.mark.parametrize(("name", "soft"), [("fig-5-5", True), ("fig-5-6", False), ("fig-5-7", True), ("fig-5-8", False)])
def test_force_control_begins_in_light_contact(name, soft):
    environment = find(name).plant.environment
    force_n = series(soft) * (environment.surface_m - chapter5.TIP_Z_M)
    assert environment.stiffness_n_per_m == (7208.0 if soft else 53150.0)
    assert 10.0 <= force_n <= 15.0
    assert force_n + 30.0 < 60.0  # what the bias may be, with the gauge's own


def test_the_controllers_estimate_is_near_the_true_stiffness_in_series():
    for name, soft in (("fig-5-5", True), ("fig-5-6", False)):
        assert find(name).controller.impedance.environment_n_per_m == pytest.approx(series(soft), rel=0.02)


def test_the_free_space_target_swings_in_three_point_three_seconds():
    target = impedance_params(find("fig-5-2").controller.impedance, 2, 1.0)
    damped = target.natural_frequency_rad_per_s * np.sqrt(1.0 - target.damping_ratio**2)
    assert 2.0 * np.pi / damped == pytest.approx(3.3, abs=0.05)
    assert chapter5.FORCE_STEP_N / target.stiffness_n_per_m == pytest.approx(0.2)


def test_set_point_compensation_undoes_load_sharing():
    target = impedance_params(find("fig-5-5").controller.impedance, 2, 1.0)
    k_eff = find("fig-5-5").controller.impedance.environment_n_per_m
    assert target.force_gain * k_eff / (target.stiffness_n_per_m + k_eff) == pytest.approx(1.0)


def test_the_dynamic_force_stays_within_what_the_supervisor_allows():
    times, channels = reference("fig-5-8")
    force_n = channels[:, 6]
    assert (force_n.min(), force_n.max()) == pytest.approx((50.0, 250.0), abs=1e-3)
    assert find("fig-5-8").supervisor.force_limit_n > 250.0 + 10.0
    assert np.all(np.diff(force_n[(times > 7.0) & (times < 9.0)]) < 0.0)  # the tool rises where Figure 5-8 is worst


def test_the_circle_starts_at_its_top_and_is_cut_in_half():
    times, channels = reference("fig-5-9")
    x_m, z_m = channels[:, 3], channels[:, 5]
    assert np.hypot(x_m, z_m + 0.06) == pytest.approx(0.06)
    assert (x_m[0], z_m[0]) == (0.0, 0.0)
    for name in ("fig-5-9", "fig-5-11"):
        surface = find(name).plant.environment.surface_m - chapter5.TIP_Z_M
        below = z_m < surface
        assert np.mean(below) == pytest.approx(0.5, abs=0.01)
        assert times[below][0] == pytest.approx(4.0, abs=0.02)


def test_the_push_strikes_the_crate_at_its_full_speed():
    times, channels = reference("fig-5-13")
    x_m = channels[:, 3]
    gap = find("fig-5-13").plant.environment.surface_m - chapter5.TIP_X_M
    struck = np.searchsorted(x_m, gap)
    assert gap == pytest.approx(0.05)
    assert (x_m[struck + 1] - x_m[struck]) / 0.01 == pytest.approx(0.04)
    assert times[struck] == pytest.approx(1.9, abs=0.1)


def test_position_and_impedance_control_push_alike():
    impedance, position = find("fig-5-13"), find("fig-5-14")
    assert impedance.plant == position.plant
    assert impedance.reference == position.reference
    assert (impedance.controller.target, position.controller.target) == ("impedance", "cartesian")
