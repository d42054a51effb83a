import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.shared.contract.codec import Received, Rejected
from hydrohil.shared.transport.acceptance import MOST_EPOCHS, Acceptance
from tests.support.wire_scene import command_body, header


def frame(epoch, seq):
    return Received(0, "controller/command", header("controller/command", seq, epoch=epoch), command_body())


def taken(frames):
    acceptance = Acceptance()
    return acceptance, [(e, s) for e, s in frames if acceptance.take(frame(e, s)) is not None]


def test_only_what_is_newer_than_everything_before_is_taken():
    acceptance, passed = taken([(1, 0), (1, 1), (1, 1), (1, 0), (1, 2), (1, 1), (1, 3)])
    assert passed == [(1, 0), (1, 1), (1, 2), (1, 3)]
    assert (acceptance.accepted, acceptance.lost, acceptance.discarded) == (4, 0, {"sequence": 3})


def test_what_is_missing_between_two_frames_is_counted_as_lost():
    acceptance, _ = taken([(1, 0), (1, 1), (1, 5), (1, 4), (1, 6)])
    assert acceptance.lost == 3


def test_one_may_join_late_without_having_lost_anything():
    acceptance, passed = taken([(1, 1000), (1, 1001)])
    assert (acceptance.lost, len(passed)) == (0, 2)


def test_a_sender_that_starts_anew_is_taken_and_its_old_epoch_never_again():
    acceptance, passed = taken([(1, 7), (2, 0), (1, 8), (2, 1), (1, 9)])
    assert passed == [(1, 7), (2, 0), (2, 1)]
    assert acceptance.discarded == {"epoch": 2}


def test_an_abandoned_epoch_never_returns_however_many_came_since():
    _, passed = taken([(epoch, 0) for epoch in range(200)] + [(epoch, 1) for epoch in range(200)])
    assert passed == [(epoch, 0) for epoch in range(200)] + [(199, 1)]


def test_after_a_flood_of_epochs_the_bound_one_goes_on_and_no_other_is_taken():
    assert MOST_EPOCHS == 4096
    flood = [(epoch, 0) for epoch in range(MOST_EPOCHS + 1)]
    acceptance, passed = taken([*flood, (MOST_EPOCHS + 1, 0), (0, 1), (MOST_EPOCHS, 1)])
    assert passed == [*flood, (MOST_EPOCHS, 1)]
    assert acceptance.discarded == {"epoch": 2}
    assert acceptance.epoch_conflicts == MOST_EPOCHS + 2


def test_an_epoch_of_zero_is_an_epoch_like_any_other():
    _, passed = taken([(0, 0), (1, 0), (0, 1)])
    assert passed == [(0, 0), (1, 0)]


def test_a_rejected_frame_is_counted_by_cause_and_disturbs_nothing():
    acceptance = Acceptance()
    acceptance.take(frame(1, 0))
    assert acceptance.take(Rejected(0, "controller/command", "crc", "")) is None
    assert acceptance.discarded == {"crc": 1}
    assert acceptance.take(frame(1, 1)) is not None
    assert acceptance.lost == 0


def corrupt(**changes):
    return Rejected(0, "controller/command", "crc", "", header("controller/command", 3, **({"epoch": 1} | changes)))


def test_a_corrupt_frame_counts_against_the_link_only_if_its_header_still_names_the_bound_stream():
    acceptance = Acceptance()
    acceptance.take(corrupt())
    assert acceptance.link_faults == 0  # nothing is bound yet
    acceptance.take(frame(1, 0))
    for foreign in (corrupt(epoch=2), corrupt(cell="left"), corrupt(sender="plant"), corrupt()._replace(header=None)):
        acceptance.take(foreign)
    assert acceptance.link_faults == 0
    acceptance.take(corrupt())
    assert (acceptance.link_faults, acceptance.epoch_conflicts, acceptance.discarded) == (1, 0, {"crc": 6})


@pytest.mark.parametrize("cause", ["oversized", "malformed", "version", "schema", "cell", "sender"])
def test_a_frame_refused_for_another_cause_is_foreign_whatever_its_header_says(cause):
    acceptance = Acceptance()
    acceptance.take(frame(1, 0))
    acceptance.take(corrupt()._replace(cause=cause))
    assert (acceptance.link_faults, acceptance.epoch_conflicts) == (0, 0)


def test_a_frame_that_comes_again_or_too_late_counts_against_the_link_and_a_lost_one_does_not():
    acceptance, _ = taken([(1, 0), (1, 5), (1, 5), (1, 3)])
    assert (acceptance.link_faults, acceptance.epoch_conflicts, acceptance.lost) == (2, 0, 4)


def test_one_that_starts_anew_is_a_epoch_conflict_once_and_two_that_speak_at_once_are_epoch_conflicts_with_every_frame():
    assert taken([(1, 0), (1, 1), (2, 0), (2, 1), (2, 2)])[0].epoch_conflicts == 1
    acceptance, _ = taken([(1, 0), (2, 0), (1, 1), (2, 1), (1, 2), (2, 2)])
    assert (acceptance.epoch_conflicts, acceptance.link_faults) == (3, 0)


def test_the_bound_identity_is_that_of_the_newest_frame_taken():
    acceptance, _ = taken([(1, 0), (2, 7), (1, 1)])
    assert (acceptance.bound.epoch, acceptance.bound.seq) == (2, 7)


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 5)), max_size=40))
def test_what_is_taken_is_increasing_within_an_epoch_and_no_epoch_returns(frames):
    acceptance, passed = taken(frames)
    epochs = [epoch for epoch, _ in passed]
    changes = [epoch for i, epoch in enumerate(epochs) if i == 0 or epochs[i - 1] != epoch]
    assert len(changes) == len(set(changes))
    for epoch in changes:
        numbers = [seq for e, seq in passed if e == epoch]
        assert numbers == sorted(set(numbers))
    assert acceptance.accepted + sum(acceptance.discarded.values()) == len(frames)


def test_before_the_first_frame_nothing_is_counted_and_no_sender_is_bound():
    fresh = Acceptance()
    counts = (fresh.lost, fresh.accepted, fresh.other_run, fresh.link_faults, fresh.epoch_conflicts, fresh.discarded)
    assert counts == (0, 0, 0, 0, 0, {})
    assert fresh.bound is None
