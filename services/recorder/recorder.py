"""The recorder without its bus: messages in, at most one open recording and a live view out, everything counted."""

import sys
from collections.abc import Iterable
from itertools import groupby
from operator import attrgetter
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from hydrohil.services.recorder.drawing import Drawn, draw
from hydrohil.services.recorder.recording import Recording
from hydrohil.services.recorder.rows import Rows
from hydrohil.services.recorder.scene import machine
from hydrohil.services.recorder.writer import Writer
from hydrohil.shared.contract.codec import Received, Rejected
from hydrohil.shared.contract.messages import PlantDescription
from hydrohil.shared.host.qualified import UNKNOWN, Standing, plain
from hydrohil.shared.trips.events import Event, gap_event, is_reported, rejected_event
from hydrohil.shared.trips.formatting import markdown
from hydrohil.shared.trips.gaps import Counted, Sequence, count, since, unbroken
from hydrohil.shared.trips.watcher import Trips
from hydrohil.shared.units import NS_PER_S

FLUSH_NS = NS_PER_S  # what a batch holds, and what a kill loses
FLUSH_LIVE_NS = 225_000_000  # where somebody looks on; more chunks, so that a file of the recording is shorter
CHECK_NS = NS_PER_S  # a flush tells of a full disk
PART_CHUNKS = 32_768  # of one file: its index is kept in memory until the file is closed, about 2 kB a chunk


class Link(NamedTuple):
    """One publisher on one topic."""

    topic: str
    sender: str


class Output(Protocol):
    """Where rows go."""

    def send(self, drawn: Drawn) -> None:
        """Write or queue rows."""


class Recorder:
    """Counts always; writes when a recording is open or a live view is there."""

    def __init__(self, cell: str = "", live: Output | None = None, trips: Path | None = None) -> None:
        """Nothing open, nothing counted; trip reports go into the folder `trips`, if one is given."""
        self._cell = cell
        self._live = live
        self._links: dict[Link, Sequence] = {}
        self._rejected: dict[tuple[str, str], int] = {}
        self._recording: Recording | None = None
        self._at_start: dict[Link, Sequence] = {}
        self._told = ""
        self._flushed_ns = self._checked_ns = 0
        self._axis: int | None = None
        self._trips = Trips(cell, trips)
        self._told_trips: list[str] = []  # of the open recording
        self._flush_ns = FLUSH_NS if live is None else FLUSH_LIVE_NS
        self._writer = Writer(self._emit) if live is None else Writer(self._emit, count_rows=1)

    def take(self, messages: Iterable[Received | Rejected]) -> None:
        """Everything that arrived since the last call, the samples before what answers them."""
        gaps: dict[Link, tuple[Received, Counted]] = {}
        for _, run in groupby(messages, attrgetter("topic")):
            received = []
            for message in run:
                if isinstance(message, Rejected):
                    self._refused(message)
                else:
                    received.append(message)
            if received:
                self._take_run(received, gaps)
        for message, counted in gaps.values():  # one line a link and call, however many gaps
            self._tell(gap_event(message.topic, message.header, counted))
        self._lay_out()

    def _take_run(self, messages: list[Received], gaps: dict[Link, tuple[Received, Counted]]) -> None:
        """Messages of one topic: counted, kept for a trip, written."""
        link = Link(messages[0].topic, messages[0].header.sender)
        whole = unbroken(self._links.get(link), [message.header for message in messages])
        if whole is not None:
            self._links[link] = whole
        else:
            for message in messages:
                self._count(message, gaps)
        self._trips.take(*messages)
        if self._is_writing or isinstance(messages[0].body, PlantDescription):
            self._writer.take(*messages)

    def _count(self, message: Received, gaps: dict[Link, tuple[Received, Counted]]) -> None:
        header = message.header
        link = Link(message.topic, header.sender)
        counted = count(self._links.get(link), header.epoch, header.seq)
        self._links[link] = counted.sequence
        if counted.skipped or counted.restarted:
            before = gaps[link][1].skipped if link in gaps else 0
            gaps[link] = (message, counted._replace(skipped=before + counted.skipped))

    def tick(self, now_ns: int) -> None:
        """Write batches that do not fill, look after the file, report trips."""
        self._report_trips(now_ns)
        if now_ns - self._flushed_ns >= self._flush_ns:
            self._flushed_ns = now_ns
            self._writer.flush()
        if now_ns - self._checked_ns >= CHECK_NS:
            self._checked_ns = now_ns
            self._write_missing()
            self._check()
            self._bound_part()

    def record(self, path: Path, title: str, summary: str = "", qualified: Standing = UNKNOWN) -> dict[str, Any]:
        """Open a new recording; one that is open is closed first. Raises OSError if the file cannot be created.

        It carries how the cell's host is `qualified`: as a property, and in its document.
        """
        if self._recording is not None:
            self.finish("")
        axis = machine(self._writer.description).force_axis
        recording = Recording(path, title, axis)
        recording.describe("rig", cell=self._cell)
        recording.describe("qualification", **properties(qualified))
        self._writer.flush(everything=True)
        self._recording, self._axis, self._at_start = recording, axis, dict(self._links)
        self._writer.begin()
        self._told_trips = []
        self._summary, self._qualified = summary or f"# {title}", qualified
        self._emit(Rows("summary", "document", None, f"{self._summary}\n\n{qualified.words}"))
        self._check()
        return {"path": str(recording.path), "failure": recording.failure}

    def finish(self, summary: str = "") -> dict[str, Any]:
        """Write what is left, the verdicts and the counts; close. Without an open recording the reply says so."""
        recording = self._recording
        if recording is None:
            return {"path": "", "rows": 0, "gaps": 0, "bytes": 0, "failure": "no recording is open"}
        self._report_trips(0, at_once=True)
        self._write_missing()
        self._writer.flush(everything=True)
        report = self._report(recording)
        parts = (summary or self._summary, self._qualified.words, counts_table(report))
        self._emit(Rows("summary", "document", None, "\n\n".join(parts)))
        recording.close()
        self._check()
        self._recording, self._told = None, ""
        return report | {"bytes": recording.bytes, "failure": recording.failure}

    def status(self) -> dict[str, Any]:
        """What is open and what was counted since the recorder's start."""
        open_now = self._report(self._recording) if self._recording else {"path": "", "failure": ""}
        received = {f"{link.topic} {link.sender}": sequence._asdict() for link, sequence in self._links.items()}
        refused = {f"{topic} {cause}": times for (topic, cause), times in self._rejected.items()}
        return {
            "recording": open_now,
            "received": received,
            "refused": refused,
            "live_dropped": getattr(self._live, "dropped", 0),
            "trip": self._trips.status(),
        }

    def close(self) -> None:
        """Close what is open; a trip that has just happened is still reported."""
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

    def _tell(self, event: Event | None) -> None:
        if event is not None and self._is_writing:
            self._writer.tell(event)

    def _report_trips(self, now_ns: int, *, at_once: bool = False) -> None:
        """Each trip as a document and a line of the log."""
        missing = {link.topic: {"missing": s.missing, "unordered": s.unordered} for link, s in self._links.items()}
        for document in self._trips.reports(now_ns, {"recorder": missing}, at_once=at_once):
            self._told_trips.append(markdown(document))
            self._emit(Rows("trip", "document", None, "\n\n".join(self._told_trips)))
            self._tell(Event("recorder", "ERROR", f"trip report: {document['sentence']}"))

    def _refused(self, rejected: Rejected) -> None:
        key = (rejected.topic, rejected.cause)
        times = self._rejected[key] = self._rejected.get(key, 0) + 1
        if is_reported(times):
            self._tell(rejected_event(rejected, times))

    def _lay_out(self) -> None:
        """The force gauge's axis is known when the plant has described itself; the layout shows that axis."""
        axis = machine(self._writer.description).force_axis
        if self._recording is not None and axis != self._axis:
            self._axis = axis
            self._recording.lay_out(axis)

    def _bound_part(self) -> None:
        """Go on in another file before the index of this one fills memory."""
        recording = self._recording
        if recording is None or recording.failure or recording.chunks < PART_CHUNKS:
            return
        recording.next_part()
        self._writer.retell()
        self._emit(Rows("summary", "document", None, self._summary))
        if self._told_trips:
            self._emit(Rows("trip", "document", None, "\n\n".join(self._told_trips)))

    def _write_missing(self) -> None:
        for link, sequence in self._counted().items():
            self._writer.scalar(f"missing/{link.topic}/{link.sender}", float(sequence.missing))

    def _counted(self) -> dict[Link, Sequence]:
        return {link: since(sequence, self._at_start.get(link)) for link, sequence in self._links.items()}

    def _report(self, recording: Recording) -> dict[str, Any]:
        counted = self._counted()
        gaps = {f"{link.topic} {link.sender}": sequence.missing for link, sequence in counted.items()}
        return {
            "path": str(recording.path),
            "rows": sum(self._writer.rows.values()),
            "gaps": sum(gaps.values()),
            "bytes": recording.bytes,
            "files": [str(path) for path in recording.parts],
            "failure": recording.failure,
            "rows_by_topic": dict(self._writer.rows),
            "gaps_by_topic": gaps,
            "unordered": sum(sequence.unordered for sequence in counted.values()),
        }

    def _check(self) -> None:
        if self._recording is None:
            return
        failure = self._recording.failure or self._recording.check()
        if failure and failure != self._told:
            self._told = failure
            print(f"recorder: the recording has stopped, counting goes on: {failure}", file=sys.stderr, flush=True)


def properties(qualified: Standing) -> dict[str, object]:
    """How a host is qualified, as columns of a catalogue of trials; what was not measured is left out."""
    return {"words": qualified.words} | {name: value for name, value in (plain(qualified) or {}).items() if value is not None}


def counts_table(report: dict[str, Any]) -> str:
    """What the recording holds and what it misses, in Markdown."""
    rows: dict[str, int] = report["rows_by_topic"]
    gaps: dict[str, int] = report["gaps_by_topic"]
    lines = []
    for topic in sorted(rows):
        missing = sum(n for link, n in gaps.items() if link.split(" ")[0] == topic)
        lines.append(f"| {topic} | {rows[topic]} | {missing} |")
    verdict = "complete: no message is missing" if not report["gaps"] else f"**{report['gaps']} messages are missing**"
    return "\n".join(["## Recording", "", verdict, "", "| topic | rows | missing |", "|-|-:|-:|", *lines])
