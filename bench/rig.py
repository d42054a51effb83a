"""What the measuring commands share: a cell of their own, a trial in it, percentiles, tables and JSON."""

import argparse
import contextlib
import json
import os
import platform
import random
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from hydrohil.cell import processes as cells
from hydrohil.shared.compiled.kernel import source_version
from hydrohil.shared.contract.topics import SERVICES
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.units import SUBSTEP_S

FIRST_PORT, LAST_PORT = 20_000, 30_000  # below the ports that the kernel hands out
console = Console(width=None if sys.stdout.isatty() else 120, highlight=False)


def parser(description: str | None) -> argparse.ArgumentParser:
    """Options of every measuring command."""
    made = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("--port", type=int, help="first of the cell's four ports (random)")
    made.add_argument("--json", type=Path, metavar="FILE", help="write the figures")
    return made


def place_of(given: argparse.Namespace) -> cells.Place:
    """A cell that nobody else has."""
    return cells.Place(f"bench-{os.getpid()}", given.port or random.randrange(FIRST_PORT, LAST_PORT, 4))


def substeps(rate_hz: float) -> int:
    """The sampling period that is nearest to the wanted rate."""
    return round(1.0 / (rate_hz * SUBSTEP_S))


def services_options(*, realtime: bool = True, permit_ttl_ms: float | None = None) -> dict[str, list[str]]:
    """Options of each service, as `hydrohil up` passes them."""
    common = [] if realtime else ["--no-realtime"]
    lease = [] if permit_ttl_ms is None else ["--permit-ttl-ms", str(permit_ttl_ms)]
    return {"plant": common + lease, "controller": common, "supervisor": common}


@contextlib.contextmanager
def running(place: cells.Place, extra: dict[str, list[str]]) -> Iterator[tuple[Bus, cells.Processes]]:
    """A cell that dies with this process, ready; and the operator's place in it."""
    started = cells.start(place, SERVICES, with_parent=True, extra=extra)
    try:
        with cells.operator_bus(place) as bus:
            cells.await_ready(place, bus, started)
            yield bus, started
    finally:
        cells.stop(process.pid for process in started.values())


def hydrohil(*arguments: str, place: cells.Place | None = None) -> subprocess.CompletedProcess[str]:
    """`hydrohil ...` to its end; what is measured here is measured above a qualified rate too."""
    arguments += ("--unqualified",) * (arguments[0] == "run")
    where = [] if place is None else place.words
    return subprocess.run([sys.executable, "-m", "hydrohil", *arguments, *where], capture_output=True, text=True, check=False)


def table(title: str, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Print a table; floats with four digits."""
    made = Table(title=title, title_justify="left")
    for index, column in enumerate(columns):
        numbers = rows and all(isinstance(row[index], int | float) for row in rows)
        made.add_column(column, justify="right" if numbers else "left")
    for row in rows:
        made.add_row(*(f"{value:.4g}" if isinstance(value, float) else str(value) for value in row))
    console.print(made)


def finish(path: Path | None, result: dict[str, Any]) -> None:
    """Write the figures with what they were measured on."""
    if path is None:
        return
    host = {"processor": platform.processor() or platform.machine(), "cores": os.cpu_count(), "python": platform.python_version()}
    path.write_text(json.dumps({"host": host, "source_version": source_version()} | result, indent=2) + "\n")
