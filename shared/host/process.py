"""The life of a service's process: options, signals, real-time requests, exit status."""

import argparse
import os
import secrets
import signal
import socket
import sys
import time
from collections.abc import Callable
from typing import NamedTuple, NoReturn

from hydrohil.shared.exit_status import EXIT_OK, EXIT_TRANSPORT, EXIT_USAGE
from hydrohil.shared.host.realtime import (
    FIFO_PRIORITY,
    PLANT_PRIORITY,
    Granted,
    die_with_parent,
    pin_cpu,
    quiet_garbage_collection,
    request_realtime,
)
from hydrohil.shared.transport.bus import Bus, BusError
from hydrohil.shared.transport.endpoints import DEFAULT_PORT, HERE, LISTENERS, Network, address, network

_NUMBER_BITS = 62
_ALONE = {"controller": True, "supervisor": False}  # the controller has one CPU, the supervisor all others; the plant may use any
DEFAULT_CELL = "cell"
_ROUTER_POLL_S = 0.1
_ROUTER_PATIENCE_S = 1.0  # of one attempt to reach the router's host


class Options(NamedTuple):
    """Options that every service's command line has."""

    cell: str = DEFAULT_CELL
    port: int = DEFAULT_PORT
    realtime: bool = True
    with_parent: int = 0  # the starting process: end when it ends, however it ends; 0 = stay
    network: Network = HERE


class CommandLine(argparse.ArgumentParser):
    """A command line whose errors are one line, and exit status 2."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong, and end."""
        self.exit(EXIT_USAGE, f"{self.prog}: {message}\n")


def parser(service: str, description: str | None) -> CommandLine:
    """Command line that every service understands."""
    line = CommandLine(
        prog=f"hydrohil {service}",
        description=description,
        epilog=f"Example: hydrohil {service} --cell left --port 7550",
    )
    line.add_argument("--cell", default=DEFAULT_CELL, help="name of the cell; several share one network (cell)")
    line.add_argument("--port", type=int, default=DEFAULT_PORT, help=f"first of the cell's four ports ({DEFAULT_PORT})")
    line.add_argument("--hosts", default="", metavar="SERVICE=ADDRESS,...", help="where services run; not named: on 127.0.0.1")
    line.add_argument("--router", default="", metavar="tcp/ADDRESS:PORT", help="connect to this router instead of the others")
    return with_process_options(line)


def with_process_options(line: CommandLine) -> CommandLine:
    """Add the options that concern the process alone."""
    line.add_argument("--no-realtime", action="store_true", help="ask for no real-time scheduling")
    line.add_argument(
        "--with-parent",
        nargs="?",
        type=int,
        const=os.getppid(),
        default=0,
        metavar="PID",
        help="end when the starting process ends, however it ends",
    )
    return line


def options_of(line: CommandLine, given: argparse.Namespace) -> Options:
    """Options of a parsed command line; ends with status 2 if `--hosts` or `--router` cannot be read."""
    try:
        where = network(given.hosts, given.router)
    except ValueError as error:
        line.error(str(error))
    return Options(given.cell, given.port, not given.no_realtime, given.with_parent, where)


def draw_number() -> int:
    """A random number for an epoch or an arming; never 0."""
    return secrets.randbits(_NUMBER_BITS) | 1


def serve(service: str, options: Options, run: Callable[[Bus, Callable[[], bool]], None]) -> int:
    """Open the bus and call `run(bus, stopped)` until a signal; returns the exit status."""
    if options.with_parent and not die_with_parent(options.with_parent):
        return EXIT_OK
    if not await_router(service, options.network):
        return EXIT_OK
    stop: list[int] = []
    granted = request_realtime(realtime=options.realtime, priority=PLANT_PRIORITY if service == "plant" else FIFO_PRIORITY)
    if service in _ALONE:
        pin_cpu(options.port // len(LISTENERS), alone=_ALONE[service])
    try:
        with Bus(service, options.cell, options.port, draw_number(), options.network) as bus:

            def end(received: int, _frame: object) -> None:
                stop.append(received)
                bus.wake()

            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                signal.signal(number, end)
            quiet_garbage_collection()
            print(f"{service}: cell {options.cell!r}, {_place(service, options)}, {scheduling(granted)}", flush=True)
            run(bus, lambda: bool(stop))
    except BusError as error:
        print(f"{service}: {error}", file=sys.stderr, flush=True)
        return EXIT_TRANSPORT
    return EXIT_OK


def await_router(service: str, where: Network) -> bool:
    """Wait until something listens where the router should, if there is one; False if Ctrl-C came first."""
    if not where.router:
        return True
    reported = False
    try:
        while True:
            try:
                socket.create_connection(address(where.router, "--router"), _ROUTER_PATIENCE_S).close()
                return True
            except OSError:
                if not reported:
                    print(f"{service}: waits for the router at {where.router}", flush=True)
                reported = True
                time.sleep(_ROUTER_POLL_S)
    except KeyboardInterrupt:
        return False


def _place(service: str, options: Options) -> str:
    """Where a service is, in words."""
    where = options.network
    return f"router {where.router}" if where.router else f"port {options.port} on {where.host(service)}"


def scheduling(granted: Granted) -> str:
    """What the host granted, in words."""
    if granted.fifo:
        return "real-time scheduling" + (", memory locked" if granted.memory_locked else "")
    return "no real-time scheduling: expect late commands when the machine is busy"
