"""What a receiver made of the frames that came: counts by cause, told about once a second and at every cut or trip."""

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
    discarded = (acceptance.discarded[cause] for cause in CAUSES)
    return InboxCounts(
        topic,
        acceptance.accepted,
        acceptance.lost,
        acceptance.other_run,
        acceptance.link_faults,
        acceptance.epoch_conflicts,
        *discarded,
    )


def link_stats(number: int, inboxes: Iterable[Counting]) -> LinkStats:
    """Counts of every inbox of a receiver, at a sample."""
    return LinkStats(number, tuple(inbox_counts(inbox.topic.key, inbox.acceptance) for inbox in inboxes))


def due(number: int, sample_period_ns: int) -> bool:
    """Whether the counts are told at this sample: once a second of samples."""
    return number % max(1, NS_PER_S // sample_period_ns) == 0


def told(inboxes: Iterable[Counting]) -> dict[str, dict[str, int]]:
    """The same for a status: what is not zero, by topic."""
    made = {}
    for inbox in inboxes:
        counts = inbox_counts(inbox.topic.key, inbox.acceptance)._asdict()
        topic = counts.pop("topic")
        made[topic] = {name: count for name, count in counts.items() if count}
    return made
