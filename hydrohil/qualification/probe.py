"""`python -m hydrohil.qualification.probe`: one measurement in a process with a scheduling class of its own.

It prints a line of JSON, and ends with the process that started it, however that ends.
"""

import argparse
import json
import os
import signal
import subprocess
import sys
from typing import Any, NamedTuple

from hydrohil.cell.processes import CellError, Place
from hydrohil.qualification import transport
from hydrohil.qualification.spread import spread
from hydrohil.qualification.wakeups import cyclictest, lateness_us, nanosleep_lateness_us
from hydrohil.shared.exit_status import EXIT_OK, EXIT_TRANSPORT
from hydrohil.shared.host.child import environment, python_module
from hydrohil.shared.host.process import DEFAULT_CELL
from hydrohil.shared.host.realtime import Granted, die_with_parent, request_realtime
from hydrohil.shared.transport.bus import BusError
from hydrohil.shared.transport.endpoints import DEFAULT_PORT
from hydrohil.shared.units import NS_PER_S


class Settings(NamedTuple):
    """Where to measure, how often and for how long."""

    place: Place
    period_ns: int
    seconds: float
    realtime: bool

    @property
    def measurements(self) -> int:
        """Number of measurements."""
        return max(1, int(self.seconds * NS_PER_S / self.period_ns))


def wake_ups(settings: Settings) -> dict[str, Any]:
    """Lateness of every wake-up in us, and what the host granted."""
    return _measured("wakeups", settings)


def limit(settings: Settings) -> dict[str, Any]:
    """Spread of the machine's own wake-ups in us, and who measured it."""
    return _measured("limit", settings)


def ping(settings: Settings) -> dict[str, Any]:
    """Every round trip in us, and how many did not return."""
    return _measured("ping", settings)


def _measured(what: str, settings: Settings) -> dict[str, Any]:
    """What the process printed. Raises CellError with the last line of its errors."""
    line = [*python_module("hydrohil.qualification.probe"), what, "--parent", str(os.getpid())]
    line += ["--cell", settings.place.cell, "--port", str(settings.place.port)]
    line += ["--period-ns", str(settings.period_ns), "--seconds", str(settings.seconds)]
    line += [] if settings.realtime else ["--no-realtime"]
    with subprocess.Popen(line, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        try:
            out, err = child.communicate()
        finally:
            child.terminate()
    if child.returncode:
        raise CellError((err.strip().splitlines() or [f"the measurement of {what} ended with {child.returncode}"])[-1])
    values: dict[str, Any] = json.loads(out)
    return values


def _measure(what: str, settings: Settings, granted: Granted) -> dict[str, Any]:
    if what == "wakeups":
        return {"us": lateness_us(settings.period_ns, settings.measurements), "granted": granted._asdict()}
    if what == "limit":
        limit = cyclictest(settings.period_ns, settings.measurements, fifo=granted.fifo)
        if limit is not None:
            return {"us": list(limit.us), "by": limit.by}
        return {"us": list(spread(nanosleep_lateness_us(settings.period_ns, settings.measurements))), "by": "clock_nanosleep"}
    options = [] if settings.realtime else ["--no-realtime"]
    line = transport.echo_line("hydrohil.qualification.probe", settings.place, [*options, "--parent", str(os.getpid())])
    us, lost = transport.ping(settings.place, settings.period_ns, settings.measurements, line)
    return {"us": us, "lost": lost}


def main(arguments: list[str] | None = None) -> int:
    """Measure, print; returns the exit status."""
    line = argparse.ArgumentParser(prog="python -m hydrohil.qualification.probe", description=__doc__)
    line.add_argument("what", choices=("wakeups", "limit", "ping", "echo"))
    line.add_argument("--parent", type=int, required=True, help="end when this process ends")
    line.add_argument("--cell", default=DEFAULT_CELL)
    line.add_argument("--port", type=int, default=DEFAULT_PORT)
    line.add_argument("--period-ns", type=int, default=4_500_000)
    line.add_argument("--seconds", type=float, default=1.0)
    line.add_argument("--no-realtime", action="store_true")
    given = line.parse_args(arguments)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(EXIT_TRANSPORT))  # so that nothing that was started is left
    if not die_with_parent(given.parent):
        return EXIT_OK
    granted = request_realtime(realtime=not given.no_realtime)
    settings = Settings(Place(given.cell, given.port), given.period_ns, given.seconds, not given.no_realtime)
    try:
        if given.what == "echo":
            transport.echo(settings.place)
        else:
            print(json.dumps(_measure(given.what, settings, granted)))
    except (BusError, OSError) as error:
        print(error, file=sys.stderr)
        return EXIT_TRANSPORT
    return EXIT_OK


if __name__ == "__main__":
    sys.exit(main())
