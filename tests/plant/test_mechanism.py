import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.services.plant.mechanism import gravity_loads, inertias, motion_loads, posture, posture_after, tip, tip_loads
from hydrohil.services.plant.params import UNIMATE_PARAMS
from hydrohil.shared.units import GRAVITY_M_PER_S2

EPS = 1e-6
ONE_METRE = 0.212  # q3 at which d3' is 1 m
poses = st.tuples(st.floats(-1.9, 1.9), st.floats(-0.52, 0.47), st.floats(0.0, 1.04))
speeds = st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1))


def moved(q, index, by):
    return tuple(value + (by if i == index else 0.0) for i, value in enumerate(q))


def slope(function, q, index):
    return (function(moved(q, index, EPS)) - function(moved(q, index, -EPS))) / (2 * EPS)


def tip_at(q):
    return tip(posture(UNIMATE_PARAMS, q))


def inertia_at(q):
    return inertias(UNIMATE_PARAMS, posture(UNIMATE_PARAMS, q))


def height_energy(q):
    """Potential energy: the boom's mass at rho below the horizon, less what the counterbalance lifts."""
    rho = q[2] + UNIMATE_PARAMS.d3_offset_m - UNIMATE_PARAMS.boom_centre_m
    return -GRAVITY_M_PER_S2 * (UNIMATE_PARAMS.boom_mass_kg * rho - UNIMATE_PARAMS.counterbalance_kg_m) * math.sin(q[1])


def test_the_tool_of_the_level_arm_hangs_under_the_end_of_the_boom():
    assert tip_at((0.0, 0.0, ONE_METRE)) == pytest.approx((1.0, 0.0, -0.37))


def test_down_is_down_and_out_is_out():
    x_m, _, z_m = tip_at((0.0, 0.0, 0.5))
    assert tip_at((0.0, 0.1, 0.5))[2] < z_m
    assert tip_at((0.0, 0.0, 0.6))[0] > x_m
    assert tip_at((0.1, 0.0, 0.5))[1] > 0.0


@given(poses, poses, st.lists(st.booleans(), min_size=3, max_size=3))
def test_a_posture_that_follows_another_is_the_one_computed_anew_whichever_links_stood(before, q, stood):
    after = tuple(old if stands else new for old, new, stands in zip(before, q, stood, strict=True))
    assert posture_after(posture(UNIMATE_PARAMS, before), UNIMATE_PARAMS, before, after) == posture(UNIMATE_PARAMS, after)


def test_the_sines_of_a_link_that_stands_are_kept_and_of_one_that_moved_by_a_bit_are_not():
    at, kept = (0.3, 0.2, 0.5), posture(UNIMATE_PARAMS, (0.3, 0.2, 0.5))._replace(cos_1=7.0, cos_2=8.0)
    assert posture_after(kept, UNIMATE_PARAMS, at, at)[:4] == kept[:4]
    moved_on = posture_after(kept, UNIMATE_PARAMS, at, (math.nextafter(0.3, 1.0), math.nextafter(0.2, 1.0), 0.5))
    assert (moved_on.cos_1, moved_on.cos_2) == (math.cos(math.nextafter(0.3, 1.0)), math.cos(math.nextafter(0.2, 1.0)))


@given(poses, st.floats(-500, 500), st.floats(-500, 500))
def test_a_force_on_the_tip_loads_the_links_by_virtual_work(q, x_n, z_n):
    loads = tip_loads(posture(UNIMATE_PARAMS, q), x_n, z_n)
    for index in range(3):
        work = x_n * slope(lambda p: tip_at(p)[0], q, index) + z_n * slope(lambda p: tip_at(p)[2], q, index)
        assert loads[index] == pytest.approx(work, abs=1e-4)


@given(poses)
def test_weight_is_the_slope_of_the_potential_energy(q):
    loads = gravity_loads(UNIMATE_PARAMS, posture(UNIMATE_PARAMS, q))
    for index in range(3):
        assert loads[index] == pytest.approx(-slope(height_energy, q, index), abs=1e-4)


@given(poses, speeds)
def test_coriolis_and_centrifugal_loads_neither_make_nor_take_energy(q, qd):
    """d/dt sum(J v^2) / 2 = sum(v * load) + sum(dJ/dt v^2) / 2 = 0 where nothing else acts."""
    inertia = inertia_at(q)
    loads = motion_loads(UNIMATE_PARAMS, posture(UNIMATE_PARAMS, q), inertia[1], qd)
    growing = [sum(slope(lambda p, i=i: inertia_at(p)[i], q, j) * qd[j] for j in range(3)) for i in range(3)]
    power = sum(v * load for v, load in zip(qd, loads, strict=True))
    assert power + sum(g * v * v / 2 for g, v in zip(growing, qd, strict=True)) == pytest.approx(0.0, abs=1e-3)


def test_inertia_at_one_metre_is_the_stated_one():
    assert inertia_at((0.0, 0.0, ONE_METRE)) == pytest.approx((361.0, 111.0, 45.0), abs=0.1)


@given(poses)
def test_break_away_carries_the_weight_in_every_pose(q):
    weight = gravity_loads(UNIMATE_PARAMS, posture(UNIMATE_PARAMS, q))
    assert abs(weight[1]) < UNIMATE_PARAMS.down_up.breakaway_tau
    assert abs(weight[2]) < UNIMATE_PARAMS.out_in.breakaway_tau
