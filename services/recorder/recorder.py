"""The recorder without its bus: messages in, at most one open recording and a live view out, every message counted."""

import sys
from collections.abc import Iterable
from itertools import groupby
from operator import attrgetter
from pathlib import Path
from typing import Any, Protocol

from hydrohil.services.recorder.counter_rows import COUNT_ROWS
from hydrohil.services.recorder.drawing import Drawn, draw
from hydrohil.services.recorder.link_counts import LinkCounts
from hydrohil.services.recorder.recording import Recording
from hydrohil.services.recorder.rows import Rows
from hydrohil.services.recorder.scene import machine
from hydrohil.services.recorder.summary import counts_table, properties, recording_report
from hydrohil.services.recorder.writer import Writer
from hydrohil.shared.contract.codec import Received, Rejected
from hydrohil.shared.contract.messages import PlantDescription
from hydrohil.shared.host.qualified import UNKNOWN, Standing
from hydrohil.shared.trips.events import Event, is_reported, rejected_event
from hydrohil.shared.trips.formatting import markdown
from hydrohil.shared.trips.watcher import Trips
from hydrohil.shared.units import NS_PER_S

FLUSH_NS = NS_PER_S  # of rows in a batch: as much is lost if the recorder is killed
FLUSH_LIVE_NS = 225_000_000  # with a live view; it makes more chunks, so that a file of the recording is shorter
CHECK_NS = NS_PER_S  # between checks of the file: a flush finds a full disk
PART_CHUNKS = 32_768  # of one file: its index is kept in memory until the file is closed, about 2 kB a chunk


class Output(Protocol):
    """Where rows go."""

    def send(self, drawn: Drawn) -> None:
        """Write or queue rows."""


class Recorder:
    """Counts always; writes when a recording is open or a live view is there."""

    def __init__(self, cell: str = "", live: Output | None = None, trips: Path | None = None) -> None:
        """No recording is open, no message counted; trip reports go into the folder `trips`, if one is given."""
        self._cell, self._live = cell, live
        self._links = LinkCounts()
        self._rejected: dict[tuple[str, str], int] = {}  # topic and cause
        self._recording: Recording | None = None
        self._printed_failure = ""
        self._flushed_ns = self._checked_ns = 0
        self._force_axis: int | None = None
        self._machine_hash = b""  # in the open recording
        self._trips = Trips(cell, trips)
        self._trip_documents: list[str] = []  # of the open recording
        self._flush_ns = FLUSH_NS if live is None else FLUSH_LIVE_NS
        self._writer = Writer(self._emit, count_rows=COUNT_ROWS if live is None else 1)

    def take(self, messages: Iterable[Received | Rejected]) -> None:
        """Everything that arrived since the last call, the samples before the messages that answer them."""
        for _, run in groupby(messages, attrgetter("topic")):
            received = []
            for message in run:
                if isinstance(message, Rejected):
                    self._count_rejected(message)
                else:
                    received.append(message)
            if received:
                self._take_topic(received)
        for event in self._links.gap_events():
            self._log(event)
        self._update_layout()

    def _take_topic(self, messages: list[Received]) -> None:
        """Messages of one topic: counted, kept for a trip, written."""
        self._links.take(messages)
        self._trips.take(*messages)
        if self._is_writing or isinstance(messages[0].body, PlantDescription):
            self._writer.take(*messages)

    def tick(self, now_ns: int) -> None:
        """Write batches that do not fill, check the file, report trips."""
        self._report_trips(now_ns)
        if now_ns - self._flushed_ns >= self._flush_ns:
            self._flushed_ns = now_ns
            self._writer.flush()
        if now_ns - self._checked_ns >= CHECK_NS:
            self._checked_ns = now_ns
            self._write_missing()
            self._check()
            self._begin_next_part()

    def record(self, path: Path, title: str, summary: str = "", qualified: Standing = UNKNOWN) -> dict[str, Any]:
        """Open a new recording; one that is open is closed first. Raises OSError if the file cannot be created.

        It carries how the cell's host is `qualified`: as a property, and in its document.
        """
        if self._recording is not None:
            self.finish("")
        force_axis = machine(self._writer.description).force_axis
        recording = Recording(path, title, force_axis)
        recording.describe("rig", cell=self._cell)
        recording.describe("qualification", **properties(qualified))
        self._machine_hash = b""
        self._writer.flush(everything=True)
        self._recording, self._force_axis = recording, force_axis
        self._name_machine()
        self._links.begin_recording()
        self._writer.begin_recording()
        self._trip_documents = []
        self._summary, self._qualified = summary or f"# {title}", qualified
        self._emit_document("summary", self._summary, qualified.words)
        self._check()
        return {"path": str(recording.path), "failure": recording.failure}

    def finish(self, summary: str = "") -> dict[str, Any]:
        """Write waiting rows, the verdicts and the counts; close. Without an open recording the reply says so."""
        recording = self._recording
        if recording is None:
            return {"path": "", "rows": 0, "gaps": 0, "bytes": 0, "failure": "no recording is open"}
        self._report_trips(0, at_once=True)
        self._write_missing()
        self._writer.flush(everything=True)
        report = recording_report(recording, self._links.recorded(), self._writer.rows)
        self._emit_document("summary", summary or self._summary, self._qualified.words, counts_table(report))
        recording.close()
        self._check()
        self._recording, self._printed_failure = None, ""
        return report | {"bytes": recording.bytes, "failure": recording.failure}

    def status(self) -> dict[str, Any]:
        """The open recording, and the counts since the recorder's start."""
        recording: dict[str, Any] = {"path": "", "failure": ""}
        if self._recording is not None:
            recording = recording_report(self._recording, self._links.recorded(), self._writer.rows)
        return {
            "recording": recording,
            "received": self._links.status(),
            "refused": {f"{topic} {cause}": times for (topic, cause), times in self._rejected.items()},
            "live_dropped": getattr(self._live, "dropped", 0),
            "trip": self._trips.status(),
        }

    def close(self) -> None:
        """Close the recording; a trip that has just happened is still reported."""
        self._report_trips(0, at_once=True)
        self.finish()
        self._trips.close()

    @property
    def _is_writing(self) -> bool:
        return self._live is not None or self._recording is not None

    def _emit(self, rows: Rows) -> None:
        if not self._is_writing:
            return
        drawn = draw(rows)
        if self._recording is not None:
            self._recording.send(drawn)
        if self._live is not None:
            self._live.send(drawn)

    def _emit_document(self, entity: str, *paragraphs: str) -> None:
        self._emit(Rows(entity, "document", None, "\n\n".join(paragraphs)))

    def _log(self, event: Event) -> None:
        if self._is_writing:
            self._writer.log(event)

    def _report_trips(self, now_ns: int, *, at_once: bool = False) -> None:
        """Each trip as a document and a line of the log."""
        counters = {"recorder": self._links.missing()}
        for document in self._trips.reports(now_ns, counters, at_once=at_once):
            self._trip_documents.append(markdown(document))
            self._emit_document("trip", *self._trip_documents)
            self._log(Event("recorder", "ERROR", f"trip report: {document['sentence']}"))

    def _count_rejected(self, rejected: Rejected) -> None:
        key = (rejected.topic, rejected.cause)
        times = self._rejected[key] = self._rejected.get(key, 0) + 1
        if is_reported(times):
            self._log(rejected_event(rejected, times))

    def _update_layout(self) -> None:
        """Show the force gauge's axis, which is known when the plant has described itself."""
        force_axis = machine(self._writer.description).force_axis
        if self._recording is not None and force_axis != self._force_axis:
            self._force_axis = force_axis
            self._recording.set_layout(force_axis)
        self._name_machine()

    def _name_machine(self) -> None:
        """Name and hash of the machine, as a property of the recording; the last, where another one was loaded meanwhile."""
        plant = self._writer.description
        if self._recording is not None and plant is not None and plant.machine_hash != self._machine_hash:
            self._machine_hash = plant.machine_hash
            self._recording.describe("machine", machine=plant.machine.name, hash=plant.machine_hash.hex())

    def _begin_next_part(self) -> None:
        """Go on in another file before the index of this one fills memory."""
        recording = self._recording
        if recording is None or recording.failure or recording.chunks < PART_CHUNKS:
            return
        recording.next_part()
        self._writer.begin_file()
        self._emit_document("summary", self._summary)
        if self._trip_documents:
            self._emit_document("trip", *self._trip_documents)

    def _write_missing(self) -> None:
        for link, sequence in self._links.recorded().items():
            self._writer.scalar(f"missing/{link.topic}/{link.sender}", float(sequence.missing))

    def _check(self) -> None:
        if self._recording is None:
            return
        failure = self._recording.failure or self._recording.check()
        if failure and failure != self._printed_failure:
            self._printed_failure = failure
            print(f"recorder: the recording has stopped, counting goes on: {failure}", file=sys.stderr, flush=True)
