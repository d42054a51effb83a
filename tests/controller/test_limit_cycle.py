import pytest

from hydrohil.services.controller.limit_cycle import Jump, jump_sustains, least_stable_n_per_m, prospect

K_EFF = 6200.0


@pytest.mark.parametrize(
    ("stiffness", "expected"),
    [(50.0, "must"), (3100.0, "must"), (3100.1, "may"), (5e3, "may"), (12399.9, "may"), (12400.0, "cannot"), (50e3, "cannot")],
)
def test_below_half_it_must_up_to_twice_it_may_from_there_on_it_cannot(stiffness, expected):
    assert prospect(stiffness, K_EFF) == expected


def test_in_free_space_nothing_can_cycle():
    assert prospect(1.0, 0.0) == "cannot"


def remaining(stiffness, alpha, beta):
    """Error in widths of the resolution after a correction of beta to an error of alpha, by the steps of 7.1."""
    force = K_EFF * beta
    set_point_moves = -force / stiffness
    return (alpha - 1.0) + set_point_moves


@pytest.mark.parametrize("alpha", [1.0, 1.3, 2.0])
@pytest.mark.parametrize("beta", [1.0, 1.7, 2.0])
def test_at_the_least_stable_stiffness_the_remaining_error_is_one_width(alpha, beta):
    least = least_stable_n_per_m(K_EFF, alpha, beta)
    assert remaining(least, alpha, beta) == pytest.approx(-1.0)
    assert -1.0 < remaining(1.01 * least, alpha, beta) < 1.0
    assert remaining(0.99 * least, alpha, beta) < -1.0


def test_the_corners_of_alpha_and_beta_are_half_and_twice():
    assert least_stable_n_per_m(K_EFF, 2.0, 1.0) == K_EFF / 2.0
    assert least_stable_n_per_m(K_EFF) == 2.0 * K_EFF


@pytest.mark.parametrize(("alpha", "beta", "named"), [(0.99, 1.0, "alpha"), (1.0, 2.01, "beta"), (float("nan"), 1.0, "alpha")])
def test_what_lies_outside_one_and_two_is_refused_with_the_bound(alpha, beta, named):
    with pytest.raises(ValueError, match=f"{named} is .* expected 1 to 2"):
        least_stable_n_per_m(K_EFF, alpha, beta)


def jumps_of(stiffness, k_eff, jump, most=50):
    """How many jumps follow one another: the law pulls outside the dead zone until the error is the trigger's, then it jumps.

    The set-point of a target in contact follows the force; positions count from where the set-point would rest with the tool.
    """
    position, count = jump.trigger_m, 0
    direction = -1.0
    while count < most:
        position += direction * jump.jump_m
        count += 1
        set_point_error = -(1.0 + k_eff / stiffness) * direction * jump.jump_m + direction * jump.trigger_m
        if abs(set_point_error) <= jump.dead_zone_m or set_point_error * direction > 0.0:
            return count
        direction = -direction
    return count


@pytest.mark.parametrize("stiffness", [50.0, 500.0, 5e3, 13e3, 15e3, 50e3])
def test_a_jump_sustains_the_next_as_long_as_what_it_leaves_lies_beyond_the_dead_zone(stiffness):
    assert jump_sustains(stiffness, K_EFF, Jump()) is (jumps_of(stiffness, K_EFF, Jump()) == 50)


def test_on_the_limit_a_jump_sustains_nothing():
    jump = Jump(jump_m=1.0, trigger_m=1.0, dead_zone_m=0.5)
    assert not jump_sustains(2.0, 1.0, jump)
    assert jump_sustains(1.99, 1.0, jump)


def test_a_jump_smaller_than_the_dead_zone_stays_quiet_on_what_is_stiffer_than_the_environment():
    assert not jump_sustains(2.0 * K_EFF, K_EFF, Jump(jump_m=1.0e-3))
    assert jump_sustains(50.0, K_EFF, Jump(jump_m=1.0e-3))
