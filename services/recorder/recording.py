"""One recording: .rrd files with layout and arm inside, which open together. A failing disk is reported; it never blocks."""

import contextlib
import shutil
import uuid
from pathlib import Path
from types import TracebackType

import rerun as rr

from hydrohil.services.recorder.blueprint import layout
from hydrohil.services.recorder.drawing import Drawn, draw, log_static, send
from hydrohil.services.recorder.rows import Rows
from hydrohil.services.recorder.scene import DEFAULT_AXIS
from hydrohil.shared.contract.file_parts import part, parts_of

APPLICATION = "hydrohil"
SUFFIX = ".rrd"
FLUSH_TICK_S = 0.05
FLUSH_TIMEOUT_S = 0.5
TIMED_OUT = "timed out"


def unused(path: Path) -> Path:
    """`path`, or with the first number that is free; the file is created, so that no other process takes the name."""
    if path.suffix != SUFFIX:
        raise ValueError(f"{path} is no name for a recording: expected one that ends in {SUFFIX}")
    path.parent.mkdir(parents=True, exist_ok=True)
    number = 1
    while True:
        candidate = path if number == 1 else path.with_name(f"{path.stem}-{number}{path.suffix}")
        number += 1
        if parts_of(candidate) not in ([], [candidate]):  # of a recording whose first file is gone
            continue
        with contextlib.suppress(FileExistsError):
            candidate.open("xb").close()
            return candidate


class Recording:
    """Files being written. Never truncates an existing one. `failure` says why they stopped growing; "" = they grow."""

    def __init__(self, path: Path, title: str, force_axis: int = DEFAULT_AXIS) -> None:
        """Create the first file; raises OSError if there is no place for it. A disk already full is a `failure`."""
        self.path = unused(path)
        self.parts = [self.path]
        self.rows = 0
        self.chunks = 0  # of the file that is open
        self.failure = ""
        self._title, self._axis = title, force_axis
        self._properties: dict[str, dict[str, object]] = {}
        self._id = str(uuid.uuid4())
        self._open()

    def _open(self) -> None:
        self.chunks = 0
        self._stream = rr.RecordingStream(
            APPLICATION,
            recording_id=self._id,
            send_properties=len(self.parts) == 1,  # the start is that of the first
            batcher_config=rr.ChunkBatcherConfig(flush_tick=FLUSH_TICK_S),
        )
        try:
            self._stream.save(self.parts[-1], default_blueprint=layout(self._axis))
            self._stream.send_recording_name(self._title)
            log_static(self._stream)
            for name, values in self._properties.items():
                self._stream.send_property(name, rr.AnyValues(**values))
        except (RuntimeError, OSError) as error:
            self._fail(error)

    def next_part(self) -> None:
        """Close the file with its footer, which frees its index, and go on in the next of the same recording."""
        if self.check():
            return
        path = part(self.path, len(self.parts) + 1)
        try:
            path.open("xb").close()
        except OSError as error:
            self._fail(error)
            return
        self._stream.disconnect()
        self.parts.append(path)
        self._open()

    def __enter__(self) -> "Recording":
        """The recording is open since its construction."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Close."""
        self.close()

    def write(self, rows: Rows) -> None:
        """Write rows; after a failure they are dropped."""
        self.send(draw(rows))

    def send(self, drawn: Drawn) -> None:
        """Write rows already drawn."""
        if self.failure:
            return
        try:
            send(self._stream, drawn)
            self.rows += drawn.rows
            self.chunks += 1
        except (RuntimeError, OSError) as error:
            self._fail(error)

    def set_layout(self, force_axis: int) -> None:
        """Replace the layout, once the axis of the force gauge is known."""
        self._axis = force_axis
        with contextlib.suppress(RuntimeError):
            self._stream.send_blueprint(layout(force_axis))

    def describe(self, name: str, **values: object) -> None:
        """A property of the whole recording: a column of a catalogue of trials."""
        self._properties[name] = values
        if not self.failure:
            self._stream.send_property(name, rr.AnyValues(**values))

    def check(self) -> str:
        """Flush: rerun's writing thread dies silently on a full disk, and only a flush reports it. Returns `failure`."""
        if not self.failure:
            try:
                self._stream.flush(timeout_sec=FLUSH_TIMEOUT_S)
            except (RuntimeError, OSError) as error:
                if TIMED_OUT not in str(error).lower():  # a slow disk is no failure
                    self._fail(error)
        return self.failure

    @property
    def bytes(self) -> int:
        """Size of all files."""
        return sum(path.stat().st_size for path in self.parts if path.exists())

    def close(self) -> None:
        """Write waiting rows and the footer."""
        self.check()
        self._stream.disconnect()

    def _fail(self, error: Exception) -> None:
        free = ""
        with contextlib.suppress(OSError):
            free = f" ({shutil.disk_usage(self.path.parent).free} bytes free on its disk)"
        self.failure = f"{self.path}: {error}{free}"
