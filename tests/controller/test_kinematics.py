import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.services.controller.kinematics import (
    CLAMPED_HIGH,
    CLAMPED_LOW,
    CLAMPED_UNREACHABLE,
    clamp_joints,
    inverse,
    joint_loads,
    tip_velocity,
)
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.contract.converters import calibration
from hydrohil.shared.contract.pose import forward, joint_positions
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.units import RAD_PER_DEG

G = UNIMATE.geometry
OUTWARD_RAD = -90 * RAD_PER_DEG
EDGES = (math.nan, math.inf, -math.inf, 0.0, -0.0, 1e300, -1e300, 1e-320, 1.0)


def test_a_level_boom_with_a_hanging_hand_reaches_straight_forward():
    x, y, z = forward(G, (0.0, 0.0, 0.212), 0.0)
    assert (x, y, z) == pytest.approx((1.0, 0.0, 0.13 - 0.5))


def test_a_hand_that_points_outward_adds_its_length_to_the_reach():
    assert forward(G, (0.0, 0.0, 0.212), OUTWARD_RAD) == pytest.approx((1.5, 0.0, 0.13))


def test_positive_joints_turn_left_go_down_and_out():
    at_rest = forward(G, (0.0, 0.0, 0.2), 0.0)
    assert forward(G, (0.1, 0.0, 0.2), 0.0)[1] > at_rest[1]
    assert forward(G, (0.0, 0.1, 0.2), 0.0)[2] < at_rest[2]
    assert forward(G, (0.0, 0.0, 0.3), 0.0)[0] > at_rest[0]


def test_the_tip_is_the_boom_and_the_hand_rotated_as_vectors():
    q, pitch = (0.4, 0.2, 0.5), -0.7
    along, across = q[2] + 0.788 - 0.5 * math.sin(pitch), 0.13 - 0.5 * math.cos(pitch)
    tip = complex(along, across) * complex(math.cos(-q[1]), math.sin(-q[1]))  # radial + i up, turned down by q2
    assert forward(G, q, pitch) == pytest.approx((tip.real * math.cos(0.4), tip.real * math.sin(0.4), tip.imag))


@given(
    st.floats(G.low_q[0], G.high_q[0]),
    st.floats(G.low_q[1], G.high_q[1]),
    st.floats(G.low_q[2], G.high_q[2]),
    st.floats(-180 * RAD_PER_DEG, 0.0),
)
def test_inverse_undoes_forward_over_the_whole_travel(q1, q2, q3, pitch):
    q, _ = inverse(G, forward(G, (q1, q2, q3), pitch), pitch)
    assert q == pytest.approx((q1, q2, q3), abs=1e-9)


@pytest.mark.parametrize("link", [0, 1, 2])
def test_a_joint_on_its_limit_passes_and_just_past_it_is_clamped_and_named(link):
    for limit, bits, past in ((G.low_q, CLAMPED_LOW, -1e-9), (G.high_q, CLAMPED_HIGH, 1e-9)):
        q = [0.1, 0.1, 0.1]
        q[link] = limit[link]
        assert clamp_joints(G, tuple(q)) == (tuple(q), 0)
        q[link] += past
        held, mask = clamp_joints(G, tuple(q))
        assert held[link] == limit[link]
        assert mask == bits[link]


def test_what_lies_above_the_reach_is_clamped_onto_the_envelope():
    q, mask = inverse(G, (0.5, 0.0, 3.0), 0.0)
    assert q[1] == G.low_q[1]
    assert q[2] == G.high_q[2]
    assert mask == CLAMPED_LOW[1] | CLAMPED_HIGH[2]


def test_the_outer_reach_at_level_boom_is_not_cut_off():
    x = forward(G, (0.0, 0.0, 1.04), 0.0)
    assert x[0] > 1.828 * math.cos(27 * RAD_PER_DEG)  # where the program's box ends
    assert inverse(G, (x[0] - 1e-6, 0.0, x[2]), 0.0)[1] == 0


def test_a_point_at_the_shoulder_is_unreachable_and_stays_finite():
    q, mask = inverse(G, (0.0, 0.0, 0.0), 0.0)
    assert mask & CLAMPED_UNREACHABLE
    assert all(math.isfinite(angle) for angle in q)


def test_a_nan_in_one_coordinate_reaches_the_joints_and_is_not_clamped_away():
    q, _ = inverse(G, (1.0, 0.0, math.nan), 0.0)
    assert math.isnan(q[1])
    assert math.isnan(q[2])


def test_counts_become_joints_by_the_programs_scales():
    q, pitch = joint_positions(calibration(UNIMATE.encoders, UNIMATE.force), (4031, 971, 207, 5, 33))
    assert q[0] / RAD_PER_DEG == pytest.approx(0.0281778 * 4031 - 113.5848)
    assert q[1] / RAD_PER_DEG == pytest.approx(-0.0284006 * 971 + 27.59)
    assert q[2] == pytest.approx(0.00105 * 207 - 0.0052)
    assert pitch / RAD_PER_DEG == pytest.approx(-0.113475 * 33 + 3.797)


def test_no_input_leaves_the_domain_and_compiled_agrees_in_every_bit():
    to_q, to_x = compiled(inverse), compiled(forward)
    for a in EDGES:
        for b in EDGES:
            for x in ((a, b, 0.3), (0.3, a, b), (b, 0.3, a)):
                assert repr(inverse(G, x, -0.5)) == repr(to_q(G, x, -0.5))
                assert repr(forward(G, x, b)) == repr(to_x(G, x, b))


@pytest.mark.parametrize("pitch", [0.0, -0.7, OUTWARD_RAD])
@pytest.mark.parametrize("q", [(0.0, 0.0, 0.212), (0.7, -0.4, 0.05), (-1.5, 0.45, 1.0)])
def test_the_tips_velocity_is_the_change_of_its_position(q, pitch):
    qd, h = (0.3, -0.8, 0.5), 1e-5
    ahead, behind = (forward(G, tuple(a + s * h * b for a, b in zip(q, qd, strict=True)), pitch) for s in (1.0, -1.0))
    want = tuple((a - b) / (2.0 * h) for a, b in zip(ahead, behind, strict=True))
    assert tip_velocity(G, q, pitch, qd) == pytest.approx(want, abs=1e-9)


def test_a_tip_one_metre_out_falls_by_a_metre_per_radian():
    assert tip_velocity(G, (0.0, 0.0, 0.212), 0.0, (0.0, 1.0, 0.0)) == pytest.approx((0.13 - 0.5, 0.0, -1.0))


def test_the_tips_velocity_leaves_no_domain_and_agrees_compiled():
    fast = compiled(tip_velocity)
    for value in EDGES:
        for q, pitch, qd in (((value, value, value), 0.1, (1.0, 2.0, 3.0)), ((0.1, 0.2, 0.3), value, (value, 1.0, value))):
            assert repr(tip_velocity(G, q, pitch, qd)) == repr(fast(G, q, pitch, qd))


@pytest.mark.parametrize("axis", [0, 2])
@given(
    st.floats(G.low_q[0], G.high_q[0]),
    st.floats(G.low_q[1], G.high_q[1]),
    st.floats(G.low_q[2], G.high_q[2]),
    st.floats(-180 * RAD_PER_DEG, 0.0),
)
def test_a_push_on_the_tip_does_the_work_that_its_joint_loads_do(axis, q1, q2, q3, pitch):
    q, step = (q1, q2, q3), 1e-6
    loads = joint_loads(G, q, pitch, axis, 200.0)
    for i in range(3):
        ahead, behind = (tuple(v + sign * step * (j == i) for j, v in enumerate(q)) for sign in (1.0, -1.0))
        work = 200.0 * (forward(G, ahead, pitch)[axis] - forward(G, behind, pitch)[axis])
        assert loads[i] == pytest.approx(work / (2.0 * step), abs=1e-4)


def test_the_plate_lifts_the_link_that_presses_on_it():
    assert joint_loads(G, (0.0, 0.0, 0.212), 0.0, 2, 250.0) == pytest.approx((0.0, -250.0, 0.0))
