"""Messages received and missing on every link: one publisher on one topic. Counted always, also without a recording."""

from typing import Any, NamedTuple

from hydrohil.shared.contract.codec import Received
from hydrohil.shared.trips.events import Event, gap_event
from hydrohil.shared.trips.gaps import Counted, Sequence, count, since, unbroken


class Link(NamedTuple):
    """One publisher on one topic."""

    topic: str
    sender: str


class LinkCounts:
    """Counts since the recorder's start, and since a recording's."""

    def __init__(self) -> None:
        """No message has come."""
        self._links: dict[Link, Sequence] = {}
        self._at_start: dict[Link, Sequence] = {}
        self._gaps: dict[Link, tuple[Received, Counted]] = {}  # since the last `gap_events`

    def take(self, messages: list[Received]) -> None:
        """Count messages of one topic."""
        link = Link(messages[0].topic, messages[0].header.sender)
        whole = unbroken(self._links.get(link), [message.header for message in messages])
        if whole is not None:
            self._links[link] = whole
            return
        for message in messages:
            self._take_one(message)

    def gap_events(self) -> list[Event]:
        """One line for each link with gaps since the last call, however many gaps it had."""
        gaps, self._gaps = self._gaps, {}
        found = (gap_event(message.topic, message.header, counted) for message, counted in gaps.values())
        return [event for event in found if event is not None]

    def begin_recording(self) -> None:
        """From now on `recorded` counts from zero."""
        self._at_start = dict(self._links)

    def recorded(self) -> dict[Link, Sequence]:
        """Counts since the recording's start."""
        return {link: since(sequence, self._at_start.get(link)) for link, sequence in self._links.items()}

    def status(self) -> dict[str, dict[str, Any]]:
        """Counts since the recorder's start, by topic and sender."""
        return {f"{link.topic} {link.sender}": sequence._asdict() for link, sequence in self._links.items()}

    def missing(self) -> dict[str, dict[str, int]]:
        """Missing and unordered messages since the recorder's start, by topic: for a trip report."""
        return {link.topic: {"missing": s.missing, "unordered": s.unordered} for link, s in self._links.items()}

    def _take_one(self, message: Received) -> None:
        header = message.header
        link = Link(message.topic, header.sender)
        counted = count(self._links.get(link), header.epoch, header.seq)
        self._links[link] = counted.sequence
        if counted.skipped or counted.restarted:
            before = self._gaps[link][1].skipped if link in self._gaps else 0
            self._gaps[link] = (message, counted._replace(skipped=before + counted.skipped))
