import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.services.supervisor.observe import Bias, Heard, Links, Watch, bias_anew, observe_step, watch_start
from hydrohil.services.supervisor.observe_force import ForceWatch
from hydrohil.services.supervisor.observe_motion import LinkWatch, MotionWatch
from hydrohil.shared.contract.deadline_window import DeadlineWindow
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL
from tests.support.supervisor_scene import BIAS, N_PER_COUNT, PARAMS, sample

OBSERVING = PARAMS.observing
NO_LINKS = Links(0, 0, 0, 1)
RUNNING = Heard(True, 0, True, NO_LINKS)
ABSENT = RUNNING._replace(stale_ns=1)
ELSEWHERE = (100, 300, 600, 0, 33)
PUSHED = 400  # counts of the gauge, above the level that is a contact
T_NS = OBSERVING.period_ns


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


@pytest.mark.parametrize("count", range(0, 518, 7))
def test_a_force_that_stays_has_no_spread_however_its_squares_are_rounded(count):
    assert play_bias([count] * BIAS).bias.spread_n == pytest.approx(0.0, abs=1e-4)


def test_a_supervisor_that_starts_among_the_negative_ticks_takes_the_bias_of_those_it_sees():
    bias = play_bias([10] * BIAS, watch_start(), lost=(0, 1, 2)).bias
    assert (bias.mean_n, bias.samples) == (pytest.approx(10 * N_PER_COUNT), BIAS - 3)


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
    before = after(49, answers=DeadlineWindow(1, 0, 1, 1))
    assert observe(before, sample(50, 5))[0].answers == DeadlineWindow(2, 0, 1, 0)
    assert observe(before, sample(50, 0))[0].answers == DeadlineWindow()
    assert observe(before, sample(50, 5), RUNNING._replace(running=False))[0].answers == DeadlineWindow()
    assert bias_anew(before).answers == DeadlineWindow()


def test_absence_leaves_the_answers_alone_and_a_lost_sample_counts_as_not_answered():
    before = after(49, answers=DeadlineWindow(1, 0, 1, 1))
    assert observe(before, sample(49, 5, command_number=0), RUNNING._replace(stale_ns=1))[0].answers == before.answers
    watch, seen = observe(before, sample(52, 7))
    assert (watch.answers.missed, seen.transport.missed) == (3, 3)


def test_frames_of_another_run_matter_to_a_trial_that_runs():
    heard = RUNNING._replace(links=Links(1, 2, 3, 4))
    seen = observe(after(49), sample(50, -3), heard)[1].transport
    assert (seen.link_faults, seen.epoch_conflicts, seen.other_run, seen.state_lag) == (1, 2, 3, 4)
    assert observe(after(49), sample(50, -3), heard._replace(running=False))[1].transport.other_run == 0


def test_nothing_is_remembered_at_first():
    still, link = (0.0, 0.0, 0.0), LinkWatch(0, 0.0, 0)
    force, motion = ForceWatch(0, 0.0, 0.0, 0.0, 0, 0, 0.0), MotionWatch(still, 0.0, still, still, still, link, link, link)
    assert watch_start() == Watch(NO_COMMAND, NO_TRIAL, 0, Bias(0.0, 0.0, 0.0, 0.0, 0), DeadlineWindow(), force, motion)


def nothing_has_moved(seen):
    return (
        seen.motion.moved_q == (0.0, 0.0, 0.0, 0.0)
        and seen.motion.dt_s == T_NS * 1e-9
        and (seen.gauge.jump_n, seen.gauge.unexplained_n, seen.gauge.energy_j) == (0.0, 0.0, 0.0)
    )


@pytest.mark.parametrize("tick", [NO_TRIAL, -1, 5])
def test_the_first_sample_of_all_moves_nothing_wherever_the_arm_stands_and_whatever_the_gauge_reads(tick):
    seen = observe(watch_start(), sample(50, tick, encoder_counts=ELSEWHERE, force_counts=PUSHED))[1]
    assert nothing_has_moved(seen)
    assert seen.motion.counts == ELSEWHERE[:3]


@pytest.mark.parametrize(("number", "tick"), [(49, 5), (48, 5), (0, 6), (50, 4), (50, NO_TRIAL)])
def test_a_sample_that_comes_again_goes_back_or_is_of_another_trial_begins_every_window_anew(number, tick):
    watch = observe(watch_start(), sample(49, 5))[0]
    assert nothing_has_moved(observe(watch, sample(number, tick, encoder_counts=ELSEWHERE, force_counts=PUSHED))[1])


@pytest.mark.parametrize(("before", "tick"), [(NO_TRIAL, NO_TRIAL), (-1, 0), (5, 5), (5, 6)])
def test_a_newer_sample_of_the_same_trial_or_still_of_none_is_told_with_its_way(before, tick):
    watch, first = observe(watch_start(), sample(49, before))
    seen = observe(watch, sample(50, tick, encoder_counts=ELSEWHERE))[1]
    assert (
        seen.motion.moved_q[:3]
        == tuple(now - was for now, was in zip(seen.motion.q, first.motion.q, strict=True))
        != (0.0, 0.0, 0.0)
    )


def test_an_absence_judges_the_sample_before_once_more_and_takes_nothing_in():
    push = {"force_counts": PUSHED, "dac_counts": OBSERVING.codes.high}
    watch = observe(watch_start(), sample(49, 5, **push))[0]
    watch = observe(watch, sample(50, 6, encoder_counts=ELSEWHERE, **push))[0]
    watch, seen = observe(watch, sample(51, 7, encoder_counts=ELSEWHERE, **push))
    after_it, again = observe(watch, sample(51, 7, encoder_counts=ELSEWHERE, **push), ABSENT)
    assert after_it == watch
    assert (again.motion.moved_q, again.motion.dt_s, again.gauge.jump_n) == ((0.0, 0.0, 0.0, 0.0), 0.0, 0.0)
    for field in ("speed", "tip_speed_m_per_s", "idle_ns", "against"):
        assert getattr(again.motion, field) == getattr(seen.motion, field)
    assert any(seen.motion.idle_ns) and seen.motion.tip_speed_m_per_s > 0.0
    assert (again.gauge.held_ns, again.gauge.energy_j) == (seen.gauge.held_ns, seen.gauge.energy_j)


def test_an_absence_before_the_first_sample_finds_nothing_moved_and_leaves_nothing():
    watch, seen = observe(watch_start(), sample(51, NO_TRIAL, encoder_counts=ELSEWHERE, force_counts=PUSHED), ABSENT)
    assert watch == watch_start()
    assert (seen.motion.moved_q, seen.gauge.jump_n, seen.transport.lost_samples) == ((0.0, 0.0, 0.0, 0.0), 0.0, 0)


@pytest.mark.parametrize("gap", [1, 3])
def test_time_passes_by_the_stamps_up_to_twice_what_the_numbers_say_and_else_by_the_numbers(gap):
    watch = observe(watch_start(), sample(49, 5))[0]
    by_number_ns = gap * T_NS
    for by_stamp_ns, dt_ns in (
        (by_number_ns + 1_000_000, by_number_ns + 1_000_000),
        (2 * by_number_ns, 2 * by_number_ns),
        (2 * by_number_ns + 1, by_number_ns),
        (1, 1),
        (0, by_number_ns),
        (-1, by_number_ns),
    ):
        seen = observe(watch, sample(49 + gap, 5 + gap, time_ns=49 * T_NS + by_stamp_ns))[1]
        assert seen.motion.dt_s == dt_ns * 1e-9


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_work_is_done_on_the_way_against_the_force_that_the_environment_gives(axis, sign):
    observing = OBSERVING._replace(force_axis=axis, force_sign=sign)
    for there, back in ((sample(49, 5).encoder_counts, ELSEWHERE), (ELSEWHERE, sample(49, 5).encoder_counts)):
        watch, before = observe_step(watch_start(), observing, sample(49, 5, encoder_counts=there, force_counts=PUSHED), RUNNING)
        seen = observe_step(watch, observing, sample(50, 6, encoder_counts=back, force_counts=PUSHED), RUNNING)[1]
        way_m = (before.motion.tip_m[axis] - seen.motion.tip_m[axis]) * sign
        assert way_m != 0.0
        assert seen.gauge.energy_j == pytest.approx(max(0.0, seen.gauge.smooth_n * way_m))
