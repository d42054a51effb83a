"""The recorder's shell: it owns the bus and the clock, and answers record, finish and status."""

import gc
import os
import signal
import sys
import threading
import time
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hydrohil.shared.contract.topics import TOPICS
from hydrohil.shared.exit_status import EXIT_OK, EXIT_TRANSPORT
from hydrohil.shared.host.process import Options, await_router, draw_number, options_of, parser
from hydrohil.shared.host.qualified import of_plain, standing
from hydrohil.shared.host.realtime import die_with_parent, set_batch_scheduling
from hydrohil.shared.transport.bus import Bus, BusError
from hydrohil.shared.transport.inbox import Inbox
from hydrohil.shared.transport.requests import Request

if TYPE_CHECKING:
    from hydrohil.services.recorder.recorder import Recorder

DEPTH = 8192  # 8 s at 1 kHz: a slow disk fills only the recorder's ring
COLLECTED = (50_000, 20, 20)  # seldom, because the collector would scan all messages kept for a trip, and they hold no cycles
STEP_S = 0.075  # rings are drained together, so that no message costs a wake-up; three steps are a flush of the live view


def main(arguments: list[str] | None = None) -> int:
    """Run until a signal; returns the exit status."""
    line = parser("recorder", __doc__)
    line.add_argument("--folder", type=Path, default=Path("runs"), help="where recordings go (runs)")
    line.add_argument("--rrd", type=Path, help="record from the start into this file of the folder")
    line.add_argument("--trips", type=Path, help="where trip reports go (trips in that folder)")
    line.add_argument("--live", type=int, metavar="PORT", help="serve a live view on this port")
    given = line.parse_args(arguments)
    options = options_of(line, given)
    if options.with_parent and not die_with_parent(options.with_parent):
        return EXIT_OK
    if not await_router("recorder", options.network):
        return EXIT_OK
    try:
        record(options, given.folder, given.rrd, given.live, given.trips)
    except (BusError, OSError, ValueError) as error:
        print(f"recorder: {error}", file=sys.stderr, flush=True)
        return EXIT_TRANSPORT
    return EXIT_OK


def record(
    options: Options, folder: Path, rrd: Path | None = None, live_port: int | None = None, trips: Path | None = None
) -> None:
    """Record until SIGINT, SIGTERM or SIGHUP. With `rrd` from the start into that file, else between `record` and `finish`."""
    from hydrohil.services.recorder.live import Live
    from hydrohil.services.recorder.recorder import Recorder

    stop = _stop_on_signals()
    gc.set_threshold(*COLLECTED)
    set_batch_scheduling()
    with ExitStack() as stack:
        live = stack.enter_context(Live(live_port)) if live_port is not None else None
        recorder = Recorder(options.cell, live, trips if trips is not None else folder / "trips")
        if rrd is not None:
            recorder.record(folder / rrd, rrd.stem, qualified=standing(fifo=True))  # no load has said how the cell runs
        bus = stack.enter_context(Bus("recorder", options.cell, options.port, draw_number(), options.network))
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
    recorder.close()


def _answer(recorder: "Recorder", inboxes: list[Inbox], folder: Path, request: Request) -> None:
    """Answer one request."""
    _drain(recorder, inboxes)  # messages before the request belong before it
    arguments = request.arguments
    match request.verb:
        case "record":
            try:
                reply = recorder.record(
                    folder / _text(arguments, "path"),
                    title=_text(arguments, "title"),
                    summary=_text(arguments, "summary_markdown"),
                    qualified=of_plain(arguments.get("qualification")),
                )
                request.reply(reply)
            except (OSError, ValueError) as error:
                request.refuse(f"no recording: {error}")
        case "finish":
            request.reply(recorder.finish(_text(arguments, "summary_markdown")))
        case "status":
            request.reply({"pid": os.getpid()} | recorder.status())
        case verb:
            request.refuse(f"unknown request {verb!r}; the recorder knows record, finish, status")


def _text(arguments: dict[str, Any], name: str) -> str:
    return str(arguments.get(name, ""))


def _stop_on_signals() -> threading.Event:
    """Set on SIGINT, SIGTERM and a closed terminal, so that the file is closed with its footer."""
    stop = threading.Event()
    if threading.current_thread() is threading.main_thread():
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: stop.set())
    return stop
