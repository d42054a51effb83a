"""A router between the services that were started with `--router`. It forwards frames and does not read them."""

import signal
import sys
import threading

from hydrohil.shared.exit_status import EXIT_OK, EXIT_TRANSPORT
from hydrohil.shared.host.process import CommandLine, scheduling, with_process_options
from hydrohil.shared.host.realtime import die_with_parent, request_realtime
from hydrohil.shared.transport.bus import BusError, router
from hydrohil.shared.transport.endpoints import ROUTER, address

LISTEN = "--listen"


def main(arguments: list[str] | None = None) -> int:
    """Run until a signal; returns the exit status."""
    line = CommandLine(prog="hydrohil router", description=__doc__, epilog="Example: hydrohil router --listen tcp/0.0.0.0:7447")
    line.add_argument(LISTEN, default=ROUTER, metavar="tcp/ADDRESS:PORT", help=f"where clients find it ({ROUTER})")
    given = with_process_options(line).parse_args(arguments)
    try:
        address(given.listen, LISTEN)
    except ValueError as error:
        line.error(str(error))
    if given.with_parent and not die_with_parent(given.with_parent):
        return EXIT_OK
    stop = threading.Event()
    granted = request_realtime(realtime=not given.no_realtime)
    try:
        with router(given.listen):
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                signal.signal(number, lambda *_: stop.set())
            print(f"router: listens on {given.listen}, {scheduling(granted)}", flush=True)
            stop.wait()
    except BusError as error:
        print(f"router: {error}", file=sys.stderr, flush=True)
        return EXIT_TRANSPORT
    return EXIT_OK
