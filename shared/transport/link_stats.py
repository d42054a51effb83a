"""What a receiver accepted and discarded, counted by cause; published once a second and at every cut or trip."""

from collections.abc import Iterable
from typing import Protocol

from hydrohil.shared.contract.messages import InboxCounts, LinkStats
from hydrohil.shared.contract.topics import Topic
from hydrohil.shared.transport.acceptance import Acceptance
from hydrohil.shared.units import NS_PER_S


class Counting(Protocol):
    """An inbox, as far as its counts go."""

    topic: Topic
    acceptance: Acceptance


CAUSES = tuple(InboxCounts._fields[InboxCounts._fields.index("oversized") :])  # of a frame that was discarded


def inbox_counts(topic: str, acceptance: Acceptance) -> InboxCounts:
    """Counts of one inbox since its receiver's start."""
    return InboxCounts(
        topic=topic,
        accepted=acceptance.accepted,
        lost=acceptance.lost,
        other_run=acceptance.other_run,
        link_faults=acceptance.link_faults,
        epoch_conflicts=acceptance.epoch_conflicts,
        **{cause: acceptance.discarded[cause] for cause in CAUSES},
    )


def link_stats(number: int, inboxes: Iterable[Counting]) -> LinkStats:
    """Counts of every inbox of a receiver, at a sample."""
    return LinkStats(number, tuple(inbox_counts(inbox.topic.key, inbox.acceptance) for inbox in inboxes))


def due(number: int, sample_period_ns: int) -> bool:
    """Whether the counts are published at this sample: once a second of samples."""
    return number % max(1, NS_PER_S // sample_period_ns) == 0


def nonzero_counts(inboxes: Iterable[Counting]) -> dict[str, dict[str, int]]:
    """Counts that are not zero, by topic and cause: for a status."""
    found = {}
    for inbox in inboxes:
        counts = inbox_counts(inbox.topic.key, inbox.acceptance)._asdict()
        topic = counts.pop("topic")
        found[topic] = {name: count for name, count in counts.items() if count}
    return found
