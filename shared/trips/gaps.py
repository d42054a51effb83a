"""Zero loss is counted, not hoped for: every publisher numbers its messages, a skipped number is a missing message."""

from typing import NamedTuple

from hydrohil.shared.contract.codec import Header


class Sequence(NamedTuple):
    """Count of one publisher's messages on one topic."""

    epoch: int
    last: int
    received: int = 1
    missing: int = 0  # numbers skipped
    unordered: int = 0  # numbers at or below one already seen: repeated or resequenced
    restarts: int = 0  # changes of epoch; the numbers start again


class Counted(NamedTuple):
    """A message counted: the new count and what it revealed."""

    sequence: Sequence
    skipped: int  # messages missing just before this one
    restarted: bool


def count(before: Sequence | None, epoch: int, seq: int) -> Counted:
    """Count one message. The first seen of a publisher opens the count: what came before it is not missed."""
    if before is None:
        return Counted(Sequence(epoch, seq), 0, False)
    _, last, received, missing, unordered, restarts = before
    if epoch != before.epoch:
        return Counted(Sequence(epoch, seq, received + 1, missing, unordered, restarts + 1), 0, True)
    if seq <= last:
        return Counted(Sequence(epoch, last, received + 1, missing, unordered + 1, restarts), 0, False)
    skipped = seq - last - 1
    return Counted(Sequence(epoch, seq, received + 1, missing + skipped, unordered, restarts), skipped, False)


def unbroken(before: Sequence | None, headers: list[Header]) -> Sequence | None:
    """The count after messages that follow each other without a gap; None if they must be counted one by one."""
    if before is None:
        return None
    length, last = len(headers), before.last
    if [header.seq for header in headers] != list(range(last + 1, last + 1 + length)):
        return None
    if {(header.sender, header.epoch) for header in headers} != {(headers[0].sender, before.epoch)}:
        return None
    return before._replace(last=last + length, received=before.received + length)


def since(now: Sequence, start: Sequence | None) -> Sequence:
    """What was counted after `start`."""
    if start is None:
        return now
    return now._replace(
        received=now.received - start.received,
        missing=now.missing - start.missing,
        unordered=now.unordered - start.unordered,
        restarts=now.restarts - start.restarts,
    )
