"""Trip reports as files, one JSON text each; a thread of its own writes them, so the recorder never waits for the disk.

JSON opens without this project (browser, spreadsheet, MATLAB, jq), and Python's floats come back bit for bit.
`hydrohil trip` makes tables (--csv) and plots (--html) of it.
"""

import json
import queue
import sys
import threading
from pathlib import Path
from typing import Any

from hydrohil.shared.trips.report import FORMAT, Document

KEPT = 100  # reports in a folder, about 3 MB each; the oldest go
_WAITING = 8  # if the folder hangs, further reports are dropped, so that memory stays bounded
_PATTERN = "*Z-*.json"


def file_name(document: Document) -> str:
    """Sorted by time; the cause is in it."""
    return f"{document['utc'].replace(':', '').replace('-', '')}-{document['cause'].lower().replace('_', '-')}.json"


def write(folder: Path, document: Document) -> Path:
    """Write a report under a new name, whole or not at all. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(document, allow_nan=False, separators=(",", ":"))
    path = _unused(folder / file_name(document))
    part = path.with_suffix(".part")
    try:
        part.write_text(text + "\n")
        part.replace(path)
    except OSError:
        part.unlink(missing_ok=True)
        raise
    for old in reports(folder)[:-KEPT]:
        old.unlink(missing_ok=True)
    return path


def _unused(path: Path) -> Path:
    number, candidate = 1, path
    while candidate.exists():
        number += 1
        candidate = path.with_stem(f"{path.stem}-{number}")
    return candidate


def reports(folder: Path) -> list[Path]:
    """The reports in a folder, oldest first."""
    return sorted(folder.glob(_PATTERN), key=lambda path: (path.stat().st_mtime_ns, path.name))


def read(path: Path) -> Document:
    """The report in `path`. Raises OSError, and ValueError with one line if it is none."""
    try:
        document: Any = json.loads(path.read_text())
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path} is no trip report: {error}") from error
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise ValueError(f"{path} is no trip report: expected a JSON object whose format is {FORMAT!r}")
    return document


class TripFiles:
    """Writes reports in its own thread. A report that cannot be written gives one line on stderr, and `failure`."""

    def __init__(self, folder: Path) -> None:
        """No file and no thread before the first report."""
        self.folder, self.failure = folder, ""
        self._newest: tuple[Document, Path] | None = None
        self._queue: queue.Queue[Document | None] = queue.Queue(_WAITING)
        self._thread: threading.Thread | None = None

    def put(self, document: Document) -> None:
        """Hand a report to the thread; returns at once."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._work, name="trip reports", daemon=True)
            self._thread.start()
        try:
            self._queue.put_nowait(document)
        except queue.Full:
            self._fail("too many wait to be written")

    def path_of(self, document: Document) -> str:
        """Where a report was written; "" while it is not, and for all but the newest."""
        newest = self._newest
        return str(newest[1]) if newest is not None and newest[0] is document else ""

    def close(self, timeout_s: float = 5.0) -> None:
        """Write the waiting reports; the thread is abandoned if the folder hangs."""
        if self._thread is not None:
            try:
                self._queue.put(None, timeout=timeout_s)
            except queue.Full:
                return
            self._thread.join(timeout_s)

    def _work(self) -> None:
        while (document := self._queue.get()) is not None:
            try:
                path = write(self.folder, document)
            except OSError as error:
                self._fail(f"{self.folder}: {error.strerror or error}")
                continue
            self._newest, self.failure = (document, path.resolve()), ""

    def _fail(self, why: str) -> None:
        self.failure = why
        print(f"recorder: a trip report is not written: {why}", file=sys.stderr, flush=True)
