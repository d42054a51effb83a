import typing

from hydrohil.shared.contract.codec import MAX_FRAME_BYTES, Received, Rejected, decode, encode
from hydrohil.shared.contract.messages import InboxCounts
from hydrohil.shared.contract.topics import BY_KEY, TOPICS, expression
from hydrohil.shared.transport.acceptance import Acceptance
from hydrohil.shared.transport.inbox import Inbox
from hydrohil.shared.transport.link_stats import CAUSES, due, inbox_counts, link_stats, nonzero_counts
from tests.support.wire_scene import CELL, command_body, header

COMMAND = BY_KEY["controller/command"]


def inbox():
    box = Inbox(COMMAND, CELL, 8, lambda: None)
    for seq in (0, 3, 3):
        box.acceptance.take(Received(0, COMMAND.key, header(COMMAND.key, seq), command_body()))
    box.acceptance.take(Received(0, COMMAND.key, header(COMMAND.key, 0, epoch=99), command_body()))
    for cause in ("crc", "crc", "oversized"):
        box.acceptance.take(Rejected(0, COMMAND.key, cause, ""))
    box.acceptance.other_run = 1
    return box


def test_every_count_stands_under_its_name():
    counts = inbox_counts(COMMAND.key, inbox().acceptance)
    named = {name: count for name, count in counts._asdict().items() if count}
    assert named == {
        "topic": COMMAND.key,
        "accepted": 3,
        "lost": 2,
        "other_run": 1,
        "link_faults": 1,
        "epoch_conflicts": 1,
        "oversized": 1,
        "crc": 2,
        "sequence": 1,
    }


def test_a_status_has_the_counts_that_are_not_zero():
    counts = nonzero_counts([inbox()])
    assert counts[COMMAND.key]["crc"] == 2
    assert 0 not in counts[COMMAND.key].values()
    assert not {"malformed", "topic"} & set(counts[COMMAND.key])


def test_every_cause_for_which_a_frame_is_discarded_has_a_count():
    head, whole = header(COMMAND.key, 5), encode(expression(CELL, COMMAND.key), header(COMMAND.key, 5), command_body())

    def cause_of(frame=None, **changes):
        key = expression(CELL, COMMAND.key)
        frame = encode(key, head._replace(**changes), command_body()) if frame is None else frame
        return decode(key, COMMAND, CELL, frame, 0).cause

    causes = {
        cause_of(bytes(MAX_FRAME_BYTES + 1)),
        cause_of(b""),
        cause_of(whole[:-1]),
        cause_of(version=2),
        cause_of(schema=6),
        cause_of(cell="left"),
        cause_of(sender="plant"),
    }
    acceptance = Acceptance()
    for epoch, seq in ((1, 0), (1, 0), (2, 0), (1, 1)):
        acceptance.take(Received(0, COMMAND.key, header(COMMAND.key, seq, epoch=epoch), command_body()))
    assert causes | set(acceptance.discarded) == set(CAUSES)
    assert set(typing.get_type_hints(InboxCounts).values()) == {str, int}


def test_the_largest_counts_of_all_topics_fit_a_frame():
    full = Acceptance()
    full.accepted = full.lost = full.other_run = full.link_faults = full.epoch_conflicts = 2**63 - 1
    full.discarded.update(dict.fromkeys(CAUSES, 2**63 - 1))
    inboxes = [Inbox(topic, CELL, 1, lambda: None) for topic in TOPICS]
    for box in inboxes:
        box.acceptance = full
    key = expression(CELL, "plant/link_stats")
    frame = encode(key, header("plant/link_stats"), link_stats(2**63 - 1, inboxes))
    assert len(frame) <= MAX_FRAME_BYTES
    assert isinstance(decode(key, BY_KEY["plant/link_stats"], CELL, frame, 0), Received)


def test_the_counts_are_published_once_a_second_of_samples():
    period_ns = 4_500_000
    assert [number for number in range(700) if due(number, period_ns)] == [0, 222, 444, 666]
    assert [number for number in range(4) if due(number, 2_000_000_000)] == [0, 1, 2, 3]
