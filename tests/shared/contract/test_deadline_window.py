from hypothesis import given, settings
from hypothesis import strategies as st

from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.contract.deadline_window import WINDOW, DeadlineWindow, deadline_window_step, missed_limit, quality

step_compiled = compiled(deadline_window_step)


def play(steps):
    answers = DeadlineWindow()
    for lost, in_time in steps:
        answers = deadline_window_step(answers, lost, in_time)
    return answers


@given(st.lists(st.tuples(st.sampled_from([0, 0, 0, 1, 5, 99, 100, 400, -3]), st.booleans()), max_size=300))
def test_the_window_holds_what_the_last_hundred_samples_were(steps):
    bits = []
    for lost, in_time in steps:
        bits += [1] * min(max(lost, 0), 400) + [0 if in_time else 1]
    answers = play(steps)
    assert answers.missed == sum(bits[-WINDOW:]) == bin(answers.newer).count("1") + bin(answers.older).count("1")
    assert 0 <= answers.newer < 2**50 and 0 <= answers.older < 2**50


def test_a_miss_leaves_the_window_after_a_hundred_samples():
    answers = deadline_window_step(DeadlineWindow(), 0, False)
    for _ in range(99):
        answers = deadline_window_step(answers, 0, True)
        assert answers.missed == 1
    assert deadline_window_step(answers, 0, True) == DeadlineWindow()


def test_misses_in_a_row_are_counted_until_an_answer_is_in_time():
    assert [play([(0, False)] * n).in_a_row for n in range(5)] == [0, 1, 2, 3, 4]
    assert play([(0, False), (2, False)]).in_a_row == 4
    assert play([(0, False), (0, True)]).in_a_row == 0
    assert play([(150, False)]).in_a_row == 101


def test_quality_is_the_share_answered_in_time():
    assert [quality(missed) for missed in (0, 1, 21, 100)] == [1.0, 0.99, 0.79, 0.0]


def test_the_limit_is_one_outage_of_a_lease_and_sixteen_random_misses():
    assert [missed_limit(lease_samples) for lease_samples in (0, 4, 20)] == [17, 21, 37]


@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(-2, 120), st.booleans()), max_size=6))
def test_plain_and_compiled_windows_agree(steps):
    machine = DeadlineWindow()
    for lost, in_time in steps:
        machine = step_compiled(machine, lost, in_time)
    assert tuple(machine) == play(steps)
