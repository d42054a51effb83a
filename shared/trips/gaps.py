"""Missing messages, by their numbers: every publisher numbers its messages, so a skipped number is a missing message."""

from typing import NamedTuple

from hydrohil.shared.contract.codec import Header


class Sequence(NamedTuple):
    """Count of one publisher's messages on one topic."""

    epoch: int
    last: int
    received: int = 1
    missing: int = 0  # numbers skipped
    unordered: int = 0  # numbers at or below the last one: repeated or resequenced
    restarts: int = 0  # changes of epoch; the numbers start again


class Counted(NamedTuple):
    """The count after one message, and the gap or restart that it showed."""

    sequence: Sequence
    skipped: int  # messages missing just before this one
    restarted: bool


def count(before: Sequence | None, epoch: int, seq: int) -> Counted:
    """Count one message. The first of a publisher opens the count: earlier numbers are not missing."""
    if before is None:
        return Counted(Sequence(epoch, seq), skipped=0, restarted=False)
    after = before._replace(received=before.received + 1)
    if epoch != before.epoch:
        return Counted(after._replace(epoch=epoch, last=seq, restarts=before.restarts + 1), skipped=0, restarted=True)
    if seq <= before.last:
        return Counted(after._replace(unordered=before.unordered + 1), skipped=0, restarted=False)
    skipped = seq - before.last - 1
    return Counted(after._replace(last=seq, missing=before.missing + skipped), skipped, restarted=False)


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
