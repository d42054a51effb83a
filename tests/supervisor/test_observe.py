import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.services.supervisor.observe import (
    Bias,
    LinkHealth,
    ObserverMemory,
    SampleContext,
    bias_restart,
    observe_step,
    observer_start,
)
from hydrohil.services.supervisor.observe_force import ForceMemory
from hydrohil.services.supervisor.observe_motion import LinkProgress, MotionMemory
from hydrohil.shared.contract.deadline_window import DeadlineWindow
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL
from tests.support.supervisor_scene import BIAS, N_PER_COUNT, PARAMS, sample

OBSERVER = PARAMS.observer
NO_LINKS = LinkHealth(0, 0, 0, 1)
RUNNING = SampleContext(True, 0, True, NO_LINKS)
ABSENT = RUNNING._replace(stale_ns=1)
ELSEWHERE = (100, 300, 600, 0, 33)
PUSHED = 400  # counts of the gauge, above the level that is a contact
T_NS = OBSERVER.period_ns


def observe(memory, observed, context=RUNNING):
    return observe_step(memory, OBSERVER, observed, context)


def after(number, **changes):
    """Sample `number` has come, and left no trace but its number and these."""
    return observer_start()._replace(last_number=number, **changes)


def play_bias(counts, memory=after(99), lost=()):  # noqa: B008 (a tuple)
    for row, count in enumerate(counts):
        if row not in lost:
            memory = observe(memory, sample(100 + row, row - BIAS, force_counts=count))[0]
    return memory


@given(st.lists(st.integers(0, 40), min_size=BIAS, max_size=BIAS))
def test_bias_and_spread_are_mean_and_standard_deviation_of_the_negative_ticks(counts):
    bias = play_bias(counts).bias
    force_n = np.array(counts) * N_PER_COUNT
    assert bias.mean_n == pytest.approx(force_n.mean(), rel=1e-12, abs=1e-12)
    assert bias.spread_n == pytest.approx(force_n.std(), rel=1e-6, abs=1e-5)
    assert bias.samples == BIAS


def test_the_bias_of_a_trial_before_leaves_no_trace_even_if_the_first_tick_is_lost():
    soiled = after(99, bias=Bias(50.0, 3.0, 5000.0, 1e6, 100))
    assert bias_restart(soiled) == after(99, bias=Bias(50.0, 3.0, 0.0, 0.0, 0))
    bias = play_bias([10] * BIAS, bias_restart(soiled), lost=(0,)).bias
    assert bias.mean_n == pytest.approx(10 * N_PER_COUNT)
    assert bias.samples == BIAS - 1
    assert play_bias([10] * BIAS, soiled).bias == play_bias([10] * BIAS).bias


@pytest.mark.parametrize("count", range(0, 518, 7))
def test_a_force_that_stays_has_no_spread_however_its_squares_are_rounded(count):
    assert play_bias([count] * BIAS).bias.spread_n == pytest.approx(0.0, abs=1e-4)


def test_a_supervisor_that_starts_among_the_negative_ticks_takes_the_bias_of_those_it_sees():
    bias = play_bias([10] * BIAS, observer_start(), lost=(0, 1, 2)).bias
    assert (bias.mean_n, bias.samples) == (pytest.approx(10 * N_PER_COUNT), BIAS - 3)


def test_ticks_from_zero_on_and_absence_leave_the_bias_alone():
    memory = play_bias([10] * BIAS)
    assert observe(memory, sample(100 + BIAS, 0, force_counts=100))[0].bias == memory.bias
    assert observe(memory, sample(memory.last_number, -1, force_counts=100), RUNNING._replace(stale_ns=1))[0].bias == memory.bias
    assert observe(memory, sample(memory.last_number + 1, -BIAS - 1, force_counts=100))[0].bias == memory.bias


def test_tared_force_is_raw_force_without_the_bias():
    observed = observe(after(49, bias=Bias(20.0, 0.0, 0.0, 0.0, 0)), sample(50, 5, force_counts=100))[1]
    assert (observed.gauge.raw_n, observed.gauge.tared_n) == (100 * N_PER_COUNT, 100 * N_PER_COUNT - 20.0)


@pytest.mark.parametrize(
    ("tick", "starting", "moving"), [(NO_TRIAL, False, False), (-2, False, False), (-1, True, False), (0, True, True)]
)
def test_what_must_hold_before_motion_is_judged_a_tick_ahead_and_only_in_a_trial_that_runs(tick, starting, moving):
    observed = observe(after(49), sample(50, tick))[1]
    assert (observed.starting, observed.moving) == (starting, moving)
    at_rest = observe(after(49), sample(50, tick), RUNNING._replace(running=False))[1]
    assert (at_rest.starting, at_rest.moving) == (False, False)


def test_samples_between_are_counted_and_a_plant_that_starts_anew_is_noticed():
    assert observe(observer_start(), sample(50, 5))[1].transport.lost_samples == 0
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
    assert bias_restart(before).answers == DeadlineWindow()


def test_absence_leaves_the_answers_alone_and_a_lost_sample_counts_as_not_answered():
    before = after(49, answers=DeadlineWindow(1, 0, 1, 1))
    assert observe(before, sample(49, 5, command_number=0), RUNNING._replace(stale_ns=1))[0].answers == before.answers
    memory, observed = observe(before, sample(52, 7))
    assert (memory.answers.missed, observed.transport.missed) == (3, 3)


def test_frames_of_another_run_matter_to_a_trial_that_runs():
    context = RUNNING._replace(links=LinkHealth(1, 2, 3, 4))
    observed = observe(after(49), sample(50, -3), context)[1].transport
    assert (observed.link_faults, observed.epoch_conflicts, observed.other_run, observed.state_lag) == (1, 2, 3, 4)
    assert observe(after(49), sample(50, -3), context._replace(running=False))[1].transport.other_run == 0


def test_nothing_is_remembered_at_first():
    still, link = (0.0, 0.0, 0.0), LinkProgress(0, 0.0, 0)
    force, motion = (
        ForceMemory(counts=0, raw_n=0.0, smooth_n=0.0, explained_n=0.0, quiet_samples=0, held_ns=0, energy_j=0.0),
        MotionMemory(q=still, pitch_rad=0.0, tip_m=still, speed=still, tip_m_per_s=still, rotate=link, down_up=link, out_in=link),
    )
    assert observer_start() == ObserverMemory(
        last_number=NO_COMMAND,
        last_tick=NO_TRIAL,
        last_time_ns=0,
        bias=Bias(0.0, 0.0, 0.0, 0.0, 0),
        answers=DeadlineWindow(),
        force=force,
        motion=motion,
    )


def nothing_has_moved(observed):
    return (
        observed.motion.moved_q == (0.0, 0.0, 0.0, 0.0)
        and observed.motion.dt_s == T_NS * 1e-9
        and (observed.gauge.jump_n, observed.gauge.unexplained_n, observed.gauge.energy_j) == (0.0, 0.0, 0.0)
    )


@pytest.mark.parametrize("tick", [NO_TRIAL, -1, 5])
def test_the_first_sample_of_all_moves_nothing_wherever_the_arm_stands_and_whatever_the_gauge_reads(tick):
    observed = observe(observer_start(), sample(50, tick, encoder_counts=ELSEWHERE, force_counts=PUSHED))[1]
    assert nothing_has_moved(observed)
    assert observed.motion.counts == ELSEWHERE[:3]


@pytest.mark.parametrize(("number", "tick"), [(49, 5), (48, 5), (0, 6), (50, 4), (50, NO_TRIAL)])
def test_a_sample_that_comes_again_goes_back_or_is_of_another_trial_begins_every_window_anew(number, tick):
    memory = observe(observer_start(), sample(49, 5))[0]
    assert nothing_has_moved(observe(memory, sample(number, tick, encoder_counts=ELSEWHERE, force_counts=PUSHED))[1])


@pytest.mark.parametrize(("before", "tick"), [(NO_TRIAL, NO_TRIAL), (-1, 0), (5, 5), (5, 6)])
def test_a_newer_sample_of_the_same_trial_or_still_of_none_has_its_way(before, tick):
    memory, first = observe(observer_start(), sample(49, before))
    observed = observe(memory, sample(50, tick, encoder_counts=ELSEWHERE))[1]
    assert (
        observed.motion.moved_q[:3]
        == tuple(now - was for now, was in zip(observed.motion.q, first.motion.q, strict=True))
        != (0.0, 0.0, 0.0)
    )


def test_an_absence_judges_the_sample_before_once_more_and_takes_nothing_in():
    motion = {"force_counts": PUSHED, "dac_counts": OBSERVER.codes.high}
    memory = observe(observer_start(), sample(49, 5, **motion))[0]
    memory = observe(memory, sample(50, 6, encoder_counts=ELSEWHERE, **motion))[0]
    memory, observed = observe(memory, sample(51, 7, encoder_counts=ELSEWHERE, **motion))
    after_it, again = observe(memory, sample(51, 7, encoder_counts=ELSEWHERE, **motion), ABSENT)
    assert after_it == memory
    assert (again.motion.moved_q, again.motion.dt_s, again.gauge.jump_n) == ((0.0, 0.0, 0.0, 0.0), 0.0, 0.0)
    for field in ("speed", "tip_speed_m_per_s", "idle_ns", "against"):
        assert getattr(again.motion, field) == getattr(observed.motion, field)
    assert any(observed.motion.idle_ns) and observed.motion.tip_speed_m_per_s > 0.0
    assert (again.gauge.held_ns, again.gauge.energy_j) == (observed.gauge.held_ns, observed.gauge.energy_j)


def test_an_absence_before_the_first_sample_finds_nothing_moved_and_leaves_nothing():
    memory, observed = observe(observer_start(), sample(51, NO_TRIAL, encoder_counts=ELSEWHERE, force_counts=PUSHED), ABSENT)
    assert memory == observer_start()
    assert (observed.motion.moved_q, observed.gauge.jump_n, observed.transport.lost_samples) == ((0.0, 0.0, 0.0, 0.0), 0.0, 0)


@pytest.mark.parametrize("gap", [1, 3])
def test_time_passes_by_the_stamps_up_to_twice_what_the_numbers_say_and_else_by_the_numbers(gap):
    memory = observe(observer_start(), sample(49, 5))[0]
    by_number_ns = gap * T_NS
    for by_stamp_ns, dt_ns in (
        (by_number_ns + 1_000_000, by_number_ns + 1_000_000),
        (2 * by_number_ns, 2 * by_number_ns),
        (2 * by_number_ns + 1, by_number_ns),
        (1, 1),
        (0, by_number_ns),
        (-1, by_number_ns),
    ):
        observed = observe(memory, sample(49 + gap, 5 + gap, time_ns=49 * T_NS + by_stamp_ns))[1]
        assert observed.motion.dt_s == dt_ns * 1e-9


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_work_is_done_on_the_way_against_the_force_that_the_environment_gives(axis, sign):
    params = OBSERVER._replace(force_axis=axis, force_sign=sign)
    for there, back in ((sample(49, 5).encoder_counts, ELSEWHERE), (ELSEWHERE, sample(49, 5).encoder_counts)):
        memory, before = observe_step(observer_start(), params, sample(49, 5, encoder_counts=there, force_counts=PUSHED), RUNNING)
        observed = observe_step(memory, params, sample(50, 6, encoder_counts=back, force_counts=PUSHED), RUNNING)[1]
        way_m = (before.motion.tip_m[axis] - observed.motion.tip_m[axis]) * sign
        assert way_m != 0.0
        assert observed.gauge.energy_j == pytest.approx(max(0.0, observed.gauge.smooth_n * way_m))
