"""Values of grids, and draws that are functions of (seed, axis, repeat)."""

import math

import numpy as np
import pytest

from hydrohil.campaign.axis import Axis, Grid, LogNormal, Normal, Uniform, axis_problems, draw, values

WIDE = Axis(normal=Normal(10.0, 2.0))
CUT = Axis(normal=Normal(10.0, 2.0, 9.0, 11.0))
LOG = Axis(lognormal=LogNormal(50.0, 0.3))
FLAT = Axis(uniform=Uniform(-1.0, 3.0))


def drawn(axis: Axis, name: str = "a", seed: int = 0, count: int = 2000) -> np.ndarray:
    return np.array([draw(axis, name, seed, repeat) for repeat in range(count)])


def test_a_grid_includes_both_ends_exactly_and_spaces_as_it_says():
    linear, log = values(Axis(grid=Grid(0.1, 0.7, 4))), values(Axis(grid=Grid(1e3, 1e5, 5, "log")))
    assert linear[0] == 0.1 and linear[-1] == 0.7 and np.allclose(np.diff(linear), 0.2)
    assert log[0] == 1e3 and log[-1] == 1e5 and np.allclose(np.diff(np.log10(log)), 0.5)


def test_a_grid_may_go_downwards():
    assert values(Axis(grid=Grid(3.0, 1.0, 3))) == (3.0, 2.0, 1.0)


@pytest.mark.parametrize("axis", [WIDE, CUT, LOG, FLAT])
def test_a_draw_is_a_function_of_seed_name_and_repeat(axis: Axis):
    assert draw(axis, "a", 3, 7) == draw(axis, "a", 3, 7)
    others = {draw(axis, name, seed, repeat) for name, seed, repeat in (("a", 3, 7), ("b", 3, 7), ("a", 4, 7), ("a", 3, 8))}
    assert len(others) == 4


def test_draws_have_the_moments_of_their_distribution():
    wide, flat, log = drawn(WIDE), drawn(FLAT), np.log(drawn(LOG))
    assert abs(wide.mean() - 10.0) < 4.0 * 2.0 / math.sqrt(len(wide)) and abs(wide.std() - 2.0) < 0.15
    assert abs(flat.mean() - 1.0) < 4.0 * 4.0 / math.sqrt(12.0 * len(flat)) and -1.0 <= flat.min() < flat.max() <= 3.0
    assert abs(log.mean() - math.log(50.0)) < 4.0 * 0.3 / math.sqrt(len(log)) and abs(log.std() - 0.3) < 0.03


def test_a_distribution_that_is_cut_off_stays_inside_and_piles_up_nowhere():
    cut = drawn(CUT)
    assert cut.min() >= 9.0 and cut.max() <= 11.0
    assert len(set(cut)) == len(cut)


def test_draws_of_two_axes_do_not_follow_each_other():
    assert abs(np.corrcoef(drawn(WIDE, "a"), drawn(WIDE, "b"))[0, 1]) < 4.0 / math.sqrt(2000)


@pytest.mark.parametrize(
    ("axis", "words"),
    [
        (Axis(), "nothing to sweep over"),
        (Axis(grid=Grid(0.0, 1.0, 2), list=(1,)), "grid and list"),
        (Axis(grid=Grid(0.0, 1.0, 2, "log")), "log scale"),
        (Axis(grid=Grid(1.0, 1.0, 2)), "must differ"),
        (Axis(list=(1, "a")), "mixes"),
        (Axis(list=(1, 1)), "twice"),
        (Axis(uniform=Uniform(1.0, 1.0)), "below high"),
        (Axis(lognormal=LogNormal(1.0, 0.1, None, 0.0)), "more than 0"),
        (Axis(list=(1,), sets={"a": "import os"}), "no formula"),
    ],
)
def test_what_does_not_fit_together_is_refused(axis: Axis, words: str):
    assert any(words in line for line in axis_problems(axis))


@pytest.mark.parametrize(
    "axis", [WIDE, CUT, LOG, FLAT, Axis(list=(1, 2.5)), Axis(list=(True, False)), Axis(grid=Grid(1.0, 2.0, 2, "log"))]
)
def test_what_fits_has_no_problem(axis: Axis):
    assert axis_problems(axis) == []
