from hypothesis import given
from hypothesis import strategies as st

from hydrohil.shared.contract.codec import Header
from hydrohil.shared.trips.gaps import Counted, Sequence, count, since, unbroken


def counted(numbers: list[int], epoch: int = 1) -> Counted:
    last = count(None, epoch, numbers[0])
    for seq in numbers[1:]:
        last = count(last.sequence, epoch, seq)
    return last


def headers(numbers: list[int], epoch: int = 1, sender: str = "plant") -> list[Header]:
    return [
        Header(
            version=1,
            schema=1,
            cell="bench",
            run=0,
            experiment=b"",
            sender=sender,
            epoch=epoch,
            arming_id=0,
            seq=seq,
            echo_number=-1,
            echo_time_ns=0,
        )
        for seq in numbers
    ]


def test_the_first_message_opens_the_count_and_misses_nothing():
    assert count(None, 7, 1000) == Counted(Sequence(7, 1000), 0, False)


def test_the_next_number_is_no_gap_and_the_one_after_is_one():
    assert counted([5, 6]).sequence.missing == 0
    assert counted([5, 7]) == Counted(Sequence(1, 7, received=2, missing=1), 1, False)


def test_a_repeated_number_is_unordered_not_missing():
    assert counted([5, 6, 6]).sequence == Sequence(1, 6, received=3, unordered=1)


def test_a_late_number_does_not_open_a_second_gap():
    assert counted([5, 8, 6, 9]).sequence == Sequence(1, 9, received=4, missing=2, unordered=1)


def test_a_new_epoch_starts_the_numbers_again():
    again = count(counted([5, 6, 7]).sequence, 2, 0)
    assert again.restarted
    assert again.sequence == Sequence(2, 0, received=4, restarts=1)


@given(st.sets(st.integers(0, 200), min_size=1))
def test_missing_is_exactly_what_was_left_out(kept: set[int]):
    numbers = sorted(kept)
    assert counted(numbers).sequence.missing == numbers[-1] - numbers[0] + 1 - len(numbers)


def test_a_recording_counts_only_what_came_after_its_start():
    start = counted([0, 5]).sequence
    now = count(count(start, 1, 6).sequence, 1, 9).sequence
    assert since(now, start) == Sequence(1, 9, received=2, missing=2)
    assert since(now, None) == now


@given(st.lists(st.tuples(st.integers(0, 8), st.sampled_from([1, 1, 1, 2])), min_size=1, max_size=8))
def test_many_counted_at_once_are_counted_as_one_by_one_or_not_at_all(messages: list[tuple[int, int]]):
    before = Sequence(1, 3, received=2, missing=1)
    one_by_one = before
    for seq, epoch in messages:
        one_by_one = count(one_by_one, epoch, seq).sequence
    at_once = unbroken(before, [headers([seq], epoch)[0] for seq, epoch in messages])
    whole = messages == [(4 + i, 1) for i in range(len(messages))]
    assert at_once == (one_by_one if whole else None)


def test_two_senders_and_a_first_message_are_not_counted_at_once():
    assert unbroken(Sequence(1, 3), headers([4, 5])) == Sequence(1, 5, received=3)
    assert unbroken(Sequence(1, 3), headers([4]) + headers([5], sender="other")) is None
    assert unbroken(None, headers([4, 5])) is None
