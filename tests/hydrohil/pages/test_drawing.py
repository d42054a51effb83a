from xml.etree import ElementTree

import numpy as np
import pytest

from hydrohil.claims.study import Curve, Panel
from hydrohil.claims.trace import Trace
from hydrohil.pages.drawing import INK, STYLES, svg
from hydrohil.pages.panels import CONTROL, MEASURED, NOMINAL, SET_POINT, SURFACE, Picture, computed, pictures
from hydrohil.thesis.library import find

T_S = np.arange(0.0, 10.0, 0.01)


def trace():
    wave = np.sin(T_S)
    links = np.stack([wave, wave, wave], axis=1)
    fields = dict.fromkeys(Trace._fields, links) | {"t_s": T_S, "force_n": wave, "force_set_n": wave, "x_nominal_m": 2.0 * links}
    return Trace(**fields)


def labels(picture):
    return [[curve.label for curve in panel.curves] for panel in picture.panels]


def axes(picture):
    return [panel.y_label for panel in picture.panels]


def test_a_trial_of_chapter_4_is_position_error_and_control_of_its_link():
    (picture,) = pictures(find("fig-4-25"), trace())
    assert axes(picture) == ["joint 2, deg", "error, deg", "control 2, mA"]
    assert labels(picture)[0] == [MEASURED, SET_POINT]
    assert picture.panels[2].curves[0].y == pytest.approx(1000.0 * np.sin(T_S))


def test_a_trial_of_chapter_5_is_force_position_and_control_over_one_axis():
    (picture,) = pictures(find("fig-5-8"), trace())
    assert axes(picture) == ["force, N", "position z, m", "control 2, mA"]
    assert picture.stacked and labels(picture) == [[MEASURED, SET_POINT], [MEASURED, SET_POINT, NOMINAL], [CONTROL]]


def test_at_the_crate_the_position_is_x_and_the_control_that_of_link_3():
    (picture,) = pictures(find("fig-5-13"), trace())
    assert axes(picture)[1:] == ["position x, m", "control 3, mA"]


def test_the_circle_is_a_path_over_the_plate_and_a_history():
    motion, history = pictures(find("fig-5-9"), trace())
    assert motion.plane and labels(motion) == [[MEASURED, SET_POINT, NOMINAL, SURFACE]]
    assert history.stacked and len(history.panels) == 3


def test_panels_of_a_study_are_stacked_only_over_the_same_axis():
    one, other = (Panel(label, "y", (Curve("a", T_S, T_S),)) for label in ("time, s", "k, N/m"))
    assert computed((one, one))[0].stacked
    assert not computed((one, other))[0].stacked
    assert computed(()) == ()


def test_a_drawing_is_one_valid_element_with_names_of_its_own_and_the_page_s_ink():
    (picture,) = pictures(find("fig-5-8"), trace())
    element = svg(picture, "fig-5-8-0", 'steps of 5 N, "up" & down')
    parsed = ElementTree.fromstring(element)
    ids = [node.get("id") for node in parsed.iter() if node.get("id")]
    assert parsed.tag == "svg" and ids and all(name.startswith("fig-5-8-0-") for name in ids)
    assert parsed.get("role") == "img" and parsed.get("aria-label") == 'steps of 5 N, "up" & down'
    assert INK not in element and "currentColor" in element
    assert "force, N" in element and "set-point" in element
    assert STYLES[SET_POINT].colour in element and "stroke-dasharray" in element
    assert len(element) < 100_000


def test_two_drawings_of_the_same_are_equal():
    picture = Picture("", (Panel("x", "y", (Curve("a", T_S, T_S), Curve("b", T_S, -T_S, points=True)), log_x=True),))
    assert svg(picture, "k", "l") == svg(picture, "k", "l")
