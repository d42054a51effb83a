import numpy as np
import pytest

from hydrohil.services.controller.config import segment_table
from hydrohil.services.controller.reference import reference_deltas
from hydrohil.shared.units import RAD_PER_DEG
from hydrohil.thesis import chapter4, claims4
from hydrohil.thesis.library import find

T_S = np.arange(0.0, 20.0, 1e-3)


def pattern_deg(name):
    """Reference of link 2 from its start, at 1 kHz."""
    experiment = find(name)
    table = segment_table(experiment.reference)
    times = T_S[experiment.duration_s > T_S]
    return times, np.array([reference_deltas(table, t)[1] for t in times]) / RAD_PER_DEG


@pytest.mark.parametrize(
    ("name", "height_deg"), [("large-ramp", 20.0), ("large-step", 20.0), ("small-ramp", 0.69), ("small-step", 1.0)]
)
def test_a_pattern_goes_there_and_back(name, height_deg):
    times, deg = pattern_deg(f"final-{name}")
    there = (times > 3.5) & (times < claims4.THERE_S)
    assert deg[0] == 0.0
    assert deg[there] == pytest.approx(height_deg)
    assert deg.max() == pytest.approx(height_deg)
    assert deg[times > 9.0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("name", "speed"), [("large-ramp", 10.0), ("small-ramp", 0.25)])
def test_ramps_reach_their_speed_smoothly(name, speed):
    times, deg = pattern_deg(f"pi-{name}")
    speeds = np.diff(deg) / np.diff(times)
    assert speeds.max() == pytest.approx(speed) and speeds.min() == pytest.approx(-speed)
    assert np.abs(np.diff(speeds)).max() < 0.05 * speed


def test_the_sine_falls_linearly_at_one_hertz():
    times, deg = pattern_deg("fig-4-25")
    assert deg == pytest.approx((1.0 - times / 20.0) * np.sin(2.0 * np.pi * times), abs=1e-9)
    last_swing = deg[(times >= 18.0) & (times <= 19.0)]
    assert np.ptp(last_swing) == pytest.approx(0.2, abs=0.05)


def test_each_figure_has_the_law_and_the_pattern_of_its_caption():
    captions = {"fig-4-2": "pi-large-ramp", "fig-4-6": "pi-sine", "fig-4-9": "morse-small-ramp", "fig-4-17": "vetia-large-step"}
    captions |= {"fig-4-23": "final-small-ramp", "fig-4-24": "final-small-step", "fig-4-25": "final-sine"}
    for name, alias in captions.items():
        assert find(name).alias == alias
        assert find(name).controller.law == alias.split("-", maxsplit=1)[0]


def test_trials_differ_in_law_and_pattern_only():
    for law in chapter4.LAWS:
        for pattern in chapter4.PATTERNS:
            experiment, other = find(f"{law}-{pattern}"), find(f"final-{pattern}")
            assert experiment.plant == other.plant
            assert experiment.reference == other.reference
            assert experiment.controller._replace(law="final") == other.controller
            assert experiment.plant.jitter_substeps == 10


def test_windows_of_claims_hold_what_they_speak_of():
    assert pytest.approx(2.0 * 0.0284006) == claims4.TWO_COUNTS_DEG
    for name in ("large-ramp", "small-ramp"):
        times, deg = pattern_deg(f"final-{name}")
        resting = (times >= 4.0) & (times <= claims4.THERE_S)
        assert np.ptp(deg[resting]) < 1e-9


def test_the_final_law_is_set_against_pi_on_every_pattern_over_the_whole_trial():
    compared = [(find(pair.of), find(pair.against), pair) for pair in chapter4.PAIRS if pair.metric == "rms_error"]
    assert {of.alias for of, _, _ in compared} == {f"pi-{pattern}" for pattern in chapter4.PATTERNS}
    for of, against, pair in compared:
        assert against.alias == of.alias.replace("pi-", "final-")
        assert (pair.start_s, pair.end_s) == (0.0, of.duration_s)
        tracking = "ramp" in of.alias or "sine" in of.alias
        assert pair.low == (4.5 if tracking else 1.0)
