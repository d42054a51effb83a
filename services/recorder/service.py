"""The recorder's shell: it owns the bus and the clock, and answers record, finish and status."""

import secrets
import signal
import threading
import time
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shared.bus import Bus, Inbox, Request
from shared.topics import TOPICS

if TYPE_CHECKING:
    from services.recorder.recorder import Recorder

DEPTH = 8192  # 8 s at 1 kHz: a slow disk fills the recorder's ring, not the others'
STEP_S = 0.04  # rings are drained in one go, so that the recorder costs no wake-up per message
EPOCH_BITS = 62


def main(cell: str, port_base: int, folder: Path, rrd: Path | None = None, live_port: int | None = None) -> None:
    """Record until SIGINT or SIGTERM. With `rrd` from the start into that file, else between `record` and `finish`."""
    from services.recorder.live import Live  # here: rerun takes 0.4 s to import
    from services.recorder.recorder import Recorder

    stop = _stop_on_signals()
    with ExitStack() as stack:
        live = stack.enter_context(Live(live_port)) if live_port is not None else None
        recorder = Recorder(cell, live)
        if rrd is not None:
            recorder.record(folder / rrd, rrd.stem)
        bus = stack.enter_context(Bus("recorder", cell, port_base, secrets.randbits(EPOCH_BITS)))
        inboxes = [bus.subscribe(topic.key, DEPTH) for topic in TOPICS]  # the plant's samples come first
        stack.callback(_finish, recorder, inboxes)
        while not stop.wait(STEP_S):
            _drain(recorder, inboxes)
            recorder.tick(time.monotonic_ns())
            for request in bus.requests():
                _answer(recorder, inboxes, folder, request)


def _drain(recorder: "Recorder", inboxes: list[Inbox]) -> None:
    for inbox in inboxes:
        recorder.take(inbox.drain())


def _finish(recorder: "Recorder", inboxes: list[Inbox]) -> None:
    _drain(recorder, inboxes)
    recorder.finish()


def _answer(recorder: "Recorder", inboxes: list[Inbox], folder: Path, request: Request) -> None:
    """One request, one answer."""
    _drain(recorder, inboxes)  # what came before the request belongs before it
    arguments = request.arguments
    match request.verb:
        case "record":
            try:
                request.reply(
                    recorder.record(
                        folder / _text(arguments, "path"), _text(arguments, "title"), _text(arguments, "summary_markdown")
                    )
                )
            except (OSError, ValueError) as error:
                request.refuse(f"no recording: {error}")
        case "finish":
            request.reply(recorder.finish(_text(arguments, "summary_markdown")))
        case "status":
            request.reply(recorder.status())
        case verb:
            request.refuse(f"unknown request {verb!r}; the recorder knows record, finish, status")


def _text(arguments: dict[str, Any], name: str) -> str:
    return str(arguments.get(name, ""))


def _stop_on_signals() -> threading.Event:
    """Set on SIGINT and SIGTERM, so that the file is closed with its footer."""
    stop = threading.Event()
    if threading.current_thread() is threading.main_thread():
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: stop.set())
    return stop
