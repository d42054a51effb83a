import math

import numpy as np
import pytest

from hydrohil.claims import cycles
from hydrohil.claims.signals import COUNT_Q
from hydrohil.claims.trace import window
from tests.hydrohil.claims.test_trace import link, standing

COUNT = COUNT_Q[1]


def square(onset_s, half_s, counts=4.0, duration_s=40.0, silent=()):
    """Link 2 goes down by 30 counts at 1 s, then from `onset_s` on jumps up and down every `half_s`, save while `silent`."""
    trace = standing(duration_s)
    t_s = trace.t_s
    jumps = np.floor((t_s - onset_s) / half_s) + 1.0
    up = (t_s >= onset_s) & (jumps % 2 == 1)
    for start_s, end_s in silent:
        up &= ~((t_s >= start_s) & (t_s < end_s))
    down = np.where(t_s < 1.0, 0.0, 30.0)
    return trace._replace(q=link((down - counts * up) * COUNT, 2))


def test_a_square_wave_has_its_onset_period_amplitude_and_number():
    trace = square(10.0, 3.0)  # up at 10, 16, .. 40; down at 13, .. 37: five times there and back
    assert cycles.cycle_onset_s(trace, "q2") == pytest.approx(10.0, abs=0.01)
    assert cycles.cycle_period_s(trace, "q2") == pytest.approx(6.0, abs=0.01)
    assert cycles.cycle_amplitude(trace, "q2") == pytest.approx(4.0 * COUNT)
    assert cycles.cycles(trace, "q2") == 5.0
    assert cycles.pause_ratio(trace, "q2") == pytest.approx(1.0, abs=0.01)


def test_a_window_that_begins_amid_the_cycles_counts_those_that_it_holds():
    later = window(square(10.0, 3.0), 20.0, 39.0)  # turns at 22, 25, 28, 31, 34, 37
    assert cycles.cycles(later, "q2") == 2.0
    assert cycles.cycle_amplitude(later, "q2") == pytest.approx(4.0 * COUNT)


@pytest.mark.parametrize(("counts", "found"), [(1.0, 0.0), (2.0, 5.0)])
def test_one_count_is_no_cycle_and_two_are(counts, found):
    assert cycles.cycles(square(10.0, 3.0, counts), "q2") == found


def test_a_link_that_rests_has_no_cycle_and_determines_nothing_of_it():
    trace = square(100.0, 3.0)
    assert cycles.cycles(trace, "q2") == cycles.cycles(standing(5.0), "q2") == 0.0
    for rests in (trace, standing(5.0)):
        assert cycles.cycle_amplitude(rests, "q2") == cycles.pause_ratio(rests, "q2") == 0.0
        assert math.isnan(cycles.cycle_period_s(rests, "q2")) and math.isnan(cycles.cycle_onset_s(rests, "q2"))


def test_once_there_and_no_more_is_an_onset_without_a_period():
    trace = square(30.0, 30.0)
    assert cycles.cycle_onset_s(trace, "q2") == pytest.approx(30.0, abs=0.01)
    assert cycles.cycles(trace, "q2") == 0.0
    assert math.isnan(cycles.cycle_period_s(trace, "q2"))
    assert cycles.cycle_amplitude(trace, "q2") == 0.0


def test_a_pause_is_detected_amid_the_cycles_and_at_their_end():
    amid = square(5.0, 2.0, silent=((12.5, 20.9),))  # down at 11, the next up at 21
    assert cycles.pause_ratio(amid, "q2") == pytest.approx(10.0 / 2.0, rel=0.01)
    ended = square(5.0, 2.0, silent=((16.5, 41.0),))  # down at 15
    assert cycles.pause_ratio(ended, "q2") == pytest.approx(25.0 / 2.0, rel=0.01)


def test_the_tip_turns_by_what_two_counts_are_at_one_metre():
    trace = square(10.0, 3.0, 2.0)
    on_axis = trace._replace(x_m=link(-trace.q[:, 1], 3))
    assert cycles.cycles(on_axis, "z") == 5.0
    assert cycles.cycle_amplitude(on_axis, "z") == pytest.approx(2.0 * COUNT)


def test_a_sine_turns_where_it_has_come_back_by_the_threshold():
    values = np.sin(np.linspace(0.0, 4.0 * np.pi, 4001))
    found = cycles.turns(values, 0.5)
    assert [turn.extreme for turn in found] == pytest.approx([0.0, 1.0, -1.0, 1.0, -1.0], abs=1e-6)
    assert values[[turn.row for turn in found]] == pytest.approx([0.5, 0.5, -0.5, 0.5, -0.5], abs=0.01)


def test_a_set_point_that_flees_the_link_yields_and_one_that_draws_it_does_not():
    trace = square(5.0, 2.0)
    centred = trace.q[:, 1] - np.mean(trace.q[:, 1])
    rate = np.sign(centred) * 4.5e-3
    for sign, share in ((-1.0, 1.0), (1.0, 0.0)):
        driven = trace._replace(q_set=link(sign * np.concatenate(([0.0], np.cumsum(rate[:-1]))), 2))
        assert cycles.yielding_share(driven, "q2") == pytest.approx(share)
    assert cycles.yielding_share(trace, "q2") == 0.0
    rests = driven._replace(q=np.full_like(driven.q, 0.1))
    assert cycles.yielding_share(rests, "q2") == 0.0
