import numpy as np
import pytest

from hydrohil.experiment.sections import UNIMATE_PARAMS
from hydrohil.simulation.tips import tips_m


def test_the_tip_is_one_metre_out_in_the_start_pose_and_turns_with_link_1():
    ahead, aside, further = tips_m(UNIMATE_PARAMS, np.array([[0.0, 0.0, 0.212], [np.pi / 2.0, 0.0, 0.212], [0.0, 0.0, 0.312]]))
    height_m = UNIMATE_PARAMS.a2_m - UNIMATE_PARAMS.a4_m
    assert ahead == pytest.approx((1.0, 0.0, height_m))
    assert aside == pytest.approx((0.0, 1.0, height_m), abs=1e-12)
    assert further == pytest.approx((1.1, 0.0, height_m))


def test_a_link_that_is_down_lowers_the_tip():
    level, lowered = tips_m(UNIMATE_PARAMS, np.array([[0.0, 0.0, 0.212], [0.0, 0.1, 0.212]]))
    assert lowered[2] < level[2]
