"""The live view: a server fed by a thread of its own. A viewer that hangs loses rows, and blocks neither recorder nor loop."""

import socket
import threading
import uuid
from collections import deque
from types import TracebackType

import rerun as rr

from hydrohil.services.recorder.blueprint import layout
from hydrohil.services.recorder.drawing import Drawn, log_static, send
from hydrohil.services.recorder.recording import APPLICATION
from hydrohil.services.recorder.scene import DEFAULT_AXIS

KEPT_BATCHES = 2048  # about 3 s of every entity at 1 kHz; the oldest are dropped first
SERVER_MEMORY = "256MiB"  # of rows for a viewer that connects late
CLOSE_TIMEOUT_S = 2.0


class Live:
    """Rows for viewers at `rerun+http://<host>:<port>/proxy`. `send` never waits; `dropped` counts dropped batches."""

    def __init__(self, port: int, address: str = "127.0.0.1", force_axis: int = DEFAULT_AXIS) -> None:
        """Serve; raises OSError if the port is taken."""
        _require_free(address, port)
        self.dropped = 0
        self._batches: deque[Drawn] = deque()
        self._wake = threading.Condition()
        self._closed = False
        self._stream = rr.RecordingStream(APPLICATION, recording_id=f"live-{uuid.uuid4()}", send_properties=False)
        self._stream.set_sinks(
            rr.GrpcServerSink(address, port, server_memory_limit=SERVER_MEMORY), default_blueprint=layout(force_axis, live=True)
        )
        log_static(self._stream)
        self._thread = threading.Thread(target=self._feed, name="live view", daemon=True)
        self._thread.start()

    def __enter__(self) -> "Live":
        """The server, which runs since its construction."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Close."""
        self.close()

    def send(self, drawn: Drawn) -> None:
        """Queue rows; if the viewer is too slow the oldest are dropped."""
        with self._wake:
            if len(self._batches) >= KEPT_BATCHES:
                self._batches.popleft()
                self.dropped += 1
            self._batches.append(drawn)
            self._wake.notify()

    def close(self) -> None:
        """Stop feeding; a thread that hangs in a dead viewer is abandoned."""
        with self._wake:
            self._closed = True
            self._wake.notify()
        self._thread.join(CLOSE_TIMEOUT_S)
        if not self._thread.is_alive():
            self._stream.disconnect()

    def _feed(self) -> None:
        while True:
            with self._wake:
                while not self._batches and not self._closed:
                    self._wake.wait()
                if not self._batches:
                    return
                drawn = self._batches.popleft()
            send(self._stream, drawn)


def _require_free(address: str, port: int) -> None:
    """Rerun only prints a line when the port is taken."""
    with socket.socket() as probe:
        try:
            probe.bind((address, port))
        except OSError as error:
            raise OSError(f"port {port} for the live view is not free: {error.strerror}; choose another with --live") from error
