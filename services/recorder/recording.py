"""One recording: a .rrd file with its layout and the arm inside. A disk that fails is reported, never waited for."""

import contextlib
import shutil
import uuid
from pathlib import Path
from types import TracebackType

import rerun as rr

from services.recorder.blueprint import layout
from services.recorder.drawing import Drawn, draw, log_standing, send
from services.recorder.rows import Rows
from services.recorder.scene import DEFAULT_AXIS

APPLICATION = "hydrohil"
SUFFIX = ".rrd"
FLUSH_TICK_S = 0.05
FLUSH_TIMEOUT_S = 0.5
TIMED_OUT = "timed out"


def unused(path: Path) -> Path:
    """`path`, or with the first number that makes it new; the file is created, so that nobody else gets it."""
    if path.suffix != SUFFIX:
        raise ValueError(f"{path} is no name for a recording: expected one that ends in {SUFFIX}")
    path.parent.mkdir(parents=True, exist_ok=True)
    number = 1
    while True:
        candidate = path if number == 1 else path.with_name(f"{path.stem}-{number}{path.suffix}")
        try:
            candidate.open("xb").close()
            return candidate
        except FileExistsError:
            number += 1


class Recording:
    """A file being written. Never truncates an existing one. `failure` says why it stopped growing; "" = it grows."""

    def __init__(self, path: Path, title: str, force_axis: int = DEFAULT_AXIS) -> None:
        """Create the file; raises OSError if there is no place for it. A disk already full is a `failure`."""
        self.path = unused(path)
        self.rows = 0
        self.failure = ""
        self._stream = rr.RecordingStream(
            APPLICATION, recording_id=str(uuid.uuid4()), batcher_config=rr.ChunkBatcherConfig(flush_tick=FLUSH_TICK_S)
        )
        try:
            self._stream.save(self.path, default_blueprint=layout(force_axis))
            self._stream.send_recording_name(title)
            log_standing(self._stream)
        except (RuntimeError, OSError) as error:
            self._fail(error)

    def __enter__(self) -> "Recording":
        """Open since it was made."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Close."""
        self.close()

    def write(self, rows: Rows) -> None:
        """Write rows; into a recording that failed they vanish."""
        self.send(draw(rows))

    def send(self, drawn: Drawn) -> None:
        """Write rows already drawn."""
        if self.failure:
            return
        try:
            send(self._stream, drawn)
            self.rows += drawn.rows
        except (RuntimeError, OSError) as error:
            self._fail(error)

    def lay_out(self, force_axis: int) -> None:
        """Another layout, once it is known how the force gauge is mounted."""
        with contextlib.suppress(RuntimeError):
            self._stream.send_blueprint(layout(force_axis))

    def describe(self, name: str, **values: object) -> None:
        """A property of the whole recording: a column of a catalogue of trials."""
        if not self.failure:
            self._stream.send_property(name, rr.AnyValues(**values))

    def check(self) -> str:
        """Ask whether the writing thread still lives: it dies silently on a full disk, a flush tells. Returns `failure`."""
        if not self.failure:
            try:
                self._stream.flush(timeout_sec=FLUSH_TIMEOUT_S)
            except (RuntimeError, OSError) as error:
                if TIMED_OUT not in str(error).lower():  # a slow disk is no failure
                    self._fail(error)
        return self.failure

    @property
    def bytes(self) -> int:
        """Size of the file."""
        return self.path.stat().st_size if self.path.exists() else 0

    def close(self) -> None:
        """Write what is left and the footer."""
        self.check()
        self._stream.disconnect()

    def _fail(self, error: Exception) -> None:
        free = ""
        with contextlib.suppress(OSError):
            free = f" ({shutil.disk_usage(self.path.parent).free} bytes free on its disk)"
        self.failure = f"{self.path}: {error}{free}"
