"""The recorder's trips: messages of the last seconds are kept, and each trip becomes a document and a file."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from hydrohil.shared.contract.codec import Received
from hydrohil.shared.trips.events import change_words
from hydrohil.shared.trips.files import TripFiles
from hydrohil.shared.trips.report import Document, Origin, counters_of, trip_report
from hydrohil.shared.trips.ring import Caught, TripRing
from hydrohil.shared.trips.tables import SAMPLE, tables


def utc_now() -> str:
    """The time of day, for people and file names; ages are never computed from it."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def document_of(caught: Caught, utc: str, cell: str, receiver: str, counters: dict[str, Any]) -> Document | None:
    """The report of a caught trip; `receiver` names the clock of the arrivals, `counters` are added to those of the receivers."""
    samples = caught.messages.get(SAMPLE)
    header = samples[-1].header if samples else None
    run, experiment = (header.run, header.experiment.hex()) if header else (0, "")
    counted = counters_of(caught.link_stats_by_receiver) | counters
    origin, changed = Origin(utc, cell, receiver, run, experiment), tuple(map(change_words, caught.changes))
    return trip_report(tables(caught.messages), origin, caught.description, counted, changed)


class Trips:
    """A ring, and a thread that writes; `folder` None = no files."""

    def __init__(self, cell: str, folder: Path | None) -> None:
        """No message has come."""
        self._cell = cell
        self._ring = TripRing()
        self._files = TripFiles(folder) if folder is not None else None
        self._last: Document | None = None

    def take(self, *messages: Received) -> None:
        """Messages of one topic, whether or not a recording is open."""
        self._ring.take(*messages)

    def reports(self, now_ns: int, counters: dict[str, Any], *, at_once: bool = False) -> list[Document]:
        """Trips that are complete by now, each handed to the writing thread."""
        found = []
        for caught in self._ring.caught(now_ns, at_once=at_once):
            document = document_of(caught, utc_now(), self._cell, "the recorder's", counters)
            if document is None:
                continue
            self._last = document
            found.append(document)
            if self._files is not None:
                self._files.put(document)
        return found

    def close(self) -> None:
        """Let the thread finish."""
        if self._files is not None:
            self._files.close()

    def status(self) -> dict[str, Any]:
        """The newest report: its trip, its file, or why there is no file."""
        if self._last is None:
            return {}
        files = self._files
        trip = {name: self._last[name] for name in ("utc", "run", "sample", "cause", "sentence")}
        return trip | {"path": files.path_of(self._last) if files else "", "failure": files.failure if files else ""}
