import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from supervisor_scene import BIAS, N_PER_COUNT, PARAMS, sample

from services.supervisor.answers import Answers
from services.supervisor.observe import Bias, Heard, Links, bias_anew, observe_step, watch_start
from shared.messages import NO_TRIAL

OBSERVING = PARAMS.observing
NO_LINKS = Links(0, 0, 0, 1)
RUNNING = Heard(True, 0, True, NO_LINKS)


def observe(watch, seen, heard=RUNNING):
    return observe_step(watch, OBSERVING, seen, heard)


def after(number, **changes):
    """Sample `number` has come, and left no trace but its number and these."""
    return watch_start()._replace(last_number=number, **changes)


def play_bias(counts, watch=after(99), lost=()):  # noqa: B008 (a tuple)
    for row, count in enumerate(counts):
        if row not in lost:
            watch = observe(watch, sample(100 + row, row - BIAS, force_counts=count))[0]
    return watch


@given(st.lists(st.integers(0, 40), min_size=BIAS, max_size=BIAS))
def test_bias_and_spread_are_mean_and_standard_deviation_of_the_negative_ticks(counts):
    bias = play_bias(counts).bias
    force_n = np.array(counts) * N_PER_COUNT
    assert bias.mean_n == pytest.approx(force_n.mean(), rel=1e-12, abs=1e-12)
    assert bias.spread_n == pytest.approx(force_n.std(), rel=1e-6, abs=1e-5)
    assert bias.samples == BIAS


def test_the_bias_of_a_trial_before_leaves_no_trace_even_if_the_first_tick_is_lost():
    soiled = after(99, bias=Bias(50.0, 3.0, 5000.0, 1e6, 100))
    assert bias_anew(soiled) == after(99, bias=Bias(50.0, 3.0, 0.0, 0.0, 0))
    bias = play_bias([10] * BIAS, bias_anew(soiled), lost=(0,)).bias
    assert bias.mean_n == pytest.approx(10 * N_PER_COUNT)
    assert bias.samples == BIAS - 1
    assert play_bias([10] * BIAS, soiled).bias == play_bias([10] * BIAS).bias


def test_ticks_from_zero_on_and_absence_leave_the_bias_alone():
    watch = play_bias([10] * BIAS)
    assert observe(watch, sample(100 + BIAS, 0, force_counts=100))[0].bias == watch.bias
    assert observe(watch, sample(watch.last_number, -1, force_counts=100), RUNNING._replace(stale_ns=1))[0].bias == watch.bias
    assert observe(watch, sample(watch.last_number + 1, -BIAS - 1, force_counts=100))[0].bias == watch.bias


def test_tared_force_is_raw_force_without_the_bias():
    seen = observe(after(49, bias=Bias(20.0, 0.0, 0.0, 0.0, 0)), sample(50, 5, force_counts=100))[1]
    assert (seen.gauge.raw_n, seen.gauge.tared_n) == (100 * N_PER_COUNT, 100 * N_PER_COUNT - 20.0)


@pytest.mark.parametrize(
    ("tick", "starting", "moving"), [(NO_TRIAL, False, False), (-2, False, False), (-1, True, False), (0, True, True)]
)
def test_what_must_hold_before_motion_is_judged_a_tick_ahead_and_only_in_a_trial_that_runs(tick, starting, moving):
    seen = observe(after(49), sample(50, tick))[1]
    assert (seen.starting, seen.moving) == (starting, moving)
    at_rest = observe(after(49), sample(50, tick), RUNNING._replace(running=False))[1]
    assert (at_rest.starting, at_rest.moving) == (False, False)


def test_samples_between_are_counted_and_a_plant_that_starts_anew_is_seen():
    assert observe(watch_start(), sample(50, 5))[1].transport.lost_samples == 0
    assert observe(after(49), sample(50, 5))[1].transport.lost_samples == 0
    assert observe(after(46), sample(50, 5))[1].transport.lost_samples == 3
    for number in (50, 51, 90):
        again = observe(after(number), sample(50, NO_TRIAL))[1]
        assert (again.moving, again.transport.lost_samples) == (True, 49 - number)
        assert not observe(after(number), sample(50, NO_TRIAL), RUNNING._replace(stale_ns=1))[1].moving
        assert not observe(after(number), sample(50, NO_TRIAL), RUNNING._replace(running=False))[1].moving
    assert observe(after(46), sample(50, 5), RUNNING._replace(stale_ns=1))[1].transport.lost_samples == 0


def test_answers_are_counted_from_tick_one_of_a_trial_that_runs():
    late = {"command_number": 0}
    for tick, missed in ((NO_TRIAL, 0), (-1, 0), (0, 0), (1, 1), (7, 1)):
        assert observe(after(49), sample(50, tick, **late))[1].transport.missed == missed
    before = after(49, answers=Answers(1, 0, 1, 1))
    assert observe(before, sample(50, 5))[0].answers == Answers(2, 0, 1, 0)
    assert observe(before, sample(50, 0))[0].answers == Answers()
    assert observe(before, sample(50, 5), RUNNING._replace(running=False))[0].answers == Answers()
    assert bias_anew(before).answers == Answers()


def test_absence_leaves_the_answers_alone_and_a_lost_sample_counts_as_not_answered():
    before = after(49, answers=Answers(1, 0, 1, 1))
    assert observe(before, sample(49, 5, command_number=0), RUNNING._replace(stale_ns=1))[0].answers == before.answers
    watch, seen = observe(before, sample(52, 7))
    assert (watch.answers.missed, seen.transport.missed) == (3, 3)


def test_frames_of_another_run_matter_to_a_trial_that_runs():
    heard = RUNNING._replace(links=Links(1, 2, 3, 4))
    seen = observe(after(49), sample(50, -3), heard)[1].transport
    assert (seen.link_faults, seen.rivals, seen.other_run, seen.state_lag) == (1, 2, 3, 4)
    assert observe(after(49), sample(50, -3), heard._replace(running=False))[1].transport.other_run == 0
