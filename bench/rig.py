"""Shared parts of the measuring commands: a cell of their own, `hydrohil ...` as a process, tables and JSON."""

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
from hydrohil.shared.host.child import environment, python_module
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.units import SUBSTEP_S

FIRST_PORT, LAST_PORT = 20_000, 30_000  # below the ports that the kernel assigns
console = Console(width=None if sys.stdout.isatty() else 120, highlight=False)


def parser(description: str | None) -> argparse.ArgumentParser:
    """Options of every measuring command."""
    options = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--port", type=int, help="first of the cell's four ports (random)")
    options.add_argument("--json", type=Path, metavar="FILE", help="write the figures")
    return options


def place_of(given: argparse.Namespace) -> cells.Place:
    """A cell of its own, with random ports."""
    return cells.Place(f"bench-{os.getpid()}", given.port or random.randrange(FIRST_PORT, LAST_PORT, 4))


def substeps(rate_hz: float) -> int:
    """The sampling period that is nearest to this rate, in sub-steps."""
    return round(1.0 / (rate_hz * SUBSTEP_S))


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
    """`hydrohil ...` to its end; also above the rate that this host is qualified for."""
    arguments += ("--unqualified",) * (arguments[0] == "run")
    where = [] if place is None else place.words
    line = [*python_module("hydrohil"), *arguments, *where]
    return subprocess.run(line, env=environment(), capture_output=True, text=True, check=False)


def table(title: str, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Print a table; floats with four digits."""
    shown = Table(title=title, title_justify="left")
    for index, column in enumerate(columns):
        numbers = rows and all(isinstance(row[index], int | float) for row in rows)
        shown.add_column(column, justify="right" if numbers else "left")
    for row in rows:
        shown.add_row(*(f"{value:.4g}" if isinstance(value, float) else str(value) for value in row))
    console.print(shown)


def finish(path: Path | None, result: dict[str, Any]) -> None:
    """Write the figures, and the host on which they were measured."""
    if path is None:
        return
    host = {"processor": platform.processor() or platform.machine(), "cores": os.cpu_count(), "python": platform.python_version()}
    path.write_text(json.dumps({"host": host, "source_version": source_version()} | result, indent=2) + "\n")
