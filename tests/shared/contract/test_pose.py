import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.shared.contract.converters import calibration
from hydrohil.shared.contract.pose import forward, joint_positions
from hydrohil.shared.machine.unimate import UNIMATE

CALIBRATION = calibration(UNIMATE.encoders, UNIMATE.force)
COUNTS = st.tuples(*[st.integers(channel.low, channel.high) for channel in UNIMATE.encoders])


@given(COUNTS)
def test_counts_come_back_from_the_joint_positions_they_give(counts):
    q, pitch_rad = joint_positions(CALIBRATION, counts)
    for value, index, kept in ((q[0], 0, 0), (q[1], 1, 1), (q[2], 2, 2), (pitch_rad, 4, 3)):
        assert round((value - CALIBRATION.offset[kept]) / CALIBRATION.scale[kept]) == counts[index]


@given(st.floats(-1.9, 1.9), st.floats(-0.5, 0.4), st.floats(0.0, 1.04), st.floats(-1.0, 1.0))
def test_the_tip_is_as_far_from_the_shoulder_as_the_lengths_say(q1, q2, q3, pitch):
    x = forward(UNIMATE.geometry, (q1, q2, q3), pitch)
    along, across = q3 + 0.788 - 0.5 * math.sin(pitch), 0.13 - 0.5 * math.cos(pitch)
    assert math.dist(x, (0.0, 0.0, 0.0)) == pytest.approx(math.hypot(along, across))
    turned = forward(UNIMATE.geometry, (0.0, q2, q3), pitch)
    assert (x[0], x[1]) == pytest.approx((turned[0] * math.cos(q1), turned[0] * math.sin(q1)))
    assert x[2] == turned[2]


def test_level_and_hand_hanging_the_tip_is_at_the_boom_end_and_below():
    assert forward(UNIMATE.geometry, (0.0, 0.0, 0.212), 0.0) == pytest.approx((1.0, 0.0, 0.13 - 0.5))
    assert forward(UNIMATE.geometry, (0.0, 0.1, 0.212), 0.0)[2] < -0.37  # + is down


@pytest.mark.parametrize("index", range(4))
@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
def test_an_unknown_angle_gives_an_unknown_place_and_no_exception(index, wrong):
    values = [0.0, 0.0, 0.2, 0.0]
    values[index] = wrong
    x = forward(UNIMATE.geometry, tuple(values[:3]), values[3])
    assert not all(abs(value) < math.inf for value in x)
