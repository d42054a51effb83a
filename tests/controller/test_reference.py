import math

import numpy as np
import pytest

from hydrohil.services.controller.config import Segment, segment_table
from hydrohil.services.controller.reference import CHANNELS, COLUMNS, reference_deltas
from hydrohil.shared.compiled.kernel import compiled


def _values(channel, times, *segments):
    table = segment_table(segments)
    return [reference_deltas(table, t)[CHANNELS.index(channel)] for t in times]


def test_a_step_stands_from_its_start_on():
    step = Segment("q2", "step", start_s=0.5, amount=0.1)
    assert _values("q2", [0.0, 0.4999, 0.5, 100.0], step) == [0.0, 0.0, 0.1, 0.1]


def test_a_ramp_without_blends_is_a_straight_line_and_then_stays():
    ramp = Segment("x", "ramp", start_s=1.0, duration_s=2.0, amount=0.4)
    assert _values("x", [0.9, 1.0, 1.5, 2.0, 3.0, 9.0], ramp) == pytest.approx([0.0, 0.0, 0.1, 0.2, 0.4, 0.4])


def test_a_blended_ramp_is_two_parabolas_and_a_line_without_a_jump_in_velocity():
    blend, duration, amount = 0.3, 2.0, 0.35
    ramp = Segment("q1", "ramp", duration_s=duration, amount=amount, blend_s=blend)
    times = np.linspace(0.0, duration, 20_001)
    q = np.array(_values("q1", times, ramp))
    qd = np.gradient(q, times)
    qdd = np.gradient(qd, times)
    speed = amount / (duration - blend)
    assert qd.max() == pytest.approx(speed, rel=1e-6)
    assert qdd[100:2900] == pytest.approx(speed / blend, rel=1e-3)
    assert qdd[3100:16_900] == pytest.approx(0.0, abs=1e-6)
    assert qdd[17_100:19_900] == pytest.approx(-speed / blend, rel=1e-3)
    assert q[-1] == amount


def test_a_ramp_of_nothing_but_blends_is_allowed():
    assert _values("q1", [0.5, 1.0, 2.0], Segment("q1", "ramp", duration_s=2.0, amount=1.0, blend_s=1.0)) == [0.125, 0.5, 1.0]


def test_a_sine_starts_at_zero_whatever_its_phase_and_holds_its_last_value():
    sine = Segment("z", "sine", start_s=1.0, duration_s=1.25, amount=0.05, frequency_hz=1.0, phase_rad=0.5)
    values = _values("z", [0.5, 1.0, 1.25, 2.25, 7.0], sine)
    quarter = 0.05 * (math.sin(math.pi / 2 + 0.5) - math.sin(0.5))
    assert values == pytest.approx([0.0, 0.0, quarter, quarter, quarter], abs=1e-15)


def test_a_diminishing_sine_falls_linearly_to_its_end():
    sine = Segment("q2", "sine", duration_s=20.0, amount=1.0, amount_end=0.0, frequency_hz=1.0)
    assert _values("q2", [0.25, 10.25, 19.25, 20.0], sine) == pytest.approx([0.9875, 0.4875, 0.0375, 0.0], abs=1e-12)


def test_two_sines_draw_a_circle_through_the_start():
    circle = (
        Segment("x", "sine", duration_s=16.0, amount=0.06, frequency_hz=1 / 16),
        Segment("z", "sine", duration_s=16.0, amount=0.06, frequency_hz=1 / 16, phase_rad=math.pi / 2),
    )
    for t in np.linspace(0.0, 16.0, 33):
        _, _, _, x, _, z, _ = reference_deltas(segment_table(circle), float(t))
        assert math.sqrt(x**2 + (z + 0.06) ** 2) == pytest.approx(0.06)


def test_segments_of_a_channel_add_up_and_channels_stay_apart():
    table = segment_table(tuple(Segment(channel, "step", amount=float(i + 1)) for i, channel in enumerate(CHANNELS)) * 2)
    assert reference_deltas(table, 0.0) == (2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0)


def test_an_empty_reference_is_the_start_value():
    assert reference_deltas((), 3.0) == (0.0,) * 7


def test_rows_and_a_compiled_array_agree_in_every_bit():
    rng = np.random.default_rng(1)
    table = segment_table(
        (
            Segment("q1", "sine", 0.3, 4.0, 0.2, frequency_hz=0.7, phase_rad=1.0, amount_end=0.1),
            Segment("z", "ramp", 0.1, 3.0, 0.2, blend_s=0.7),
            Segment("force", "step", 1.0, amount=100.0),
        )
    )
    fast, array = compiled(reference_deltas), np.array(table)
    assert array.shape == (3, len(COLUMNS))
    for t in [*(float(v) for v in rng.uniform(-1.0, 6.0, 500)), 0.1, 0.3, 1.0, 3.1, math.nan, math.inf, -math.inf]:
        assert repr(reference_deltas(table, t)) == repr(fast(array, t))
    assert fast(np.empty((0, len(COLUMNS))), 1.0) == (0.0,) * 7
    for column in range(2, len(COLUMNS)):
        for edge in (math.nan, math.inf, -math.inf, 0.0, 1e308):
            wrong = array.copy()
            wrong[:, column] = edge
            rows = tuple(tuple(float(v) for v in row) for row in wrong)
            assert repr(reference_deltas(rows, 2.0)) == repr(fast(wrong, 2.0))
