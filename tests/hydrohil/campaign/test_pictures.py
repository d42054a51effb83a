"""Pictures: what a map's cells hold, and that files are written."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from hydrohil.campaign.borders import border_lines
from hydrohil.campaign.pictures import draw_all, edges, grid_of
from hydrohil.campaign.table import schema, table
from hydrohil.campaign.trials import count, trial_of
from hydrohil.services.plant.params import UNIMATE_PARAMS
from tests.support.campaign_scene import plan

STIFFNESS = {
    "target": {
        "grid": {"from": 1e2, "to": 1e5, "count": 4, "scale": "log"},
        "sets": {"controller.impedance.stiffness_n_per_m": "value"},
    },
    "plant.environment.stiffness_n_per_m": {"list": [1e4, 1e3]},
}
MAP = {"kind": "map", "of": "peak_n", "x": "plant.environment.stiffness_n_per_m", "y": "target", "border": "limit-cycle"}
ONE = plan(sweep=STIFFNESS, pictures={"map": MAP, "spread": {"kind": "distribution", "of": "peak_n", "by": "target"}})


def rows(missing=()):
    files = []
    for number in range(count(ONE.campaign)):
        trial = trial_of(ONE.campaign, number)
        peak = None if number in missing else float(10 * trial.point + trial.repeat)
        files.append(
            {"trial": number, **trial.parameters, "peak_n": peak, "ended": "tripped" if number in missing else "completed"}
        )
    return table(files, schema(ONE, "x"))


def test_a_cell_is_the_mean_of_its_repeats_and_axes_ascend():
    x, y, mean = grid_of(ONE, ONE.campaign.pictures["map"], rows(missing=(1, 2, 3)))
    assert x.tolist() == [1e3, 1e4] and np.all(np.diff(y) > 0.0)
    assert mean[0, 1] == 0.0  # repeat 1 of point 0 is missing
    assert np.isnan(mean[0, 0])  # both of point 1
    assert mean[3, 0] == pytest.approx(70.5)


def test_the_border_is_twice_and_half_k_eff_whichever_axis_the_plate_is_on():
    x, y = np.array([1e3, 1e4]), np.array([1e2, 1e5])
    gauge = UNIMATE_PARAMS.sensor_stiffness_n_per_m
    above, below = border_lines(ONE, ONE.campaign.pictures["map"], x, y)
    k_eff = above.x * gauge / (above.x + gauge)
    assert np.allclose(above.y, 2.0 * k_eff) and np.allclose(below.y, 0.5 * k_eff)
    turned = ONE.campaign.pictures["map"]._replace(x=MAP["y"], y=MAP["x"])
    assert np.allclose(border_lines(ONE, turned, y, x)[0].x, above.y)


def test_every_picture_is_written(tmp_path: Path):
    files = draw_all(ONE, rows(missing=(1, 2, 3)), tmp_path)
    assert [path.name for path in files] == ["tiny-map.png", "tiny-spread.png"]
    assert all(imread(path).std() > 0.01 for path in files)


def test_a_cell_reaches_halfway_to_its_neighbours_on_its_own_scale():
    assert edges(np.array([1.0, 2.0, 4.0]), False).tolist() == [0.5, 1.5, 3.0, 5.0]
    assert np.allclose(edges(np.array([1.0, 100.0]), True), [0.1, 10.0, 1000.0])
