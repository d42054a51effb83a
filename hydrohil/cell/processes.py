"""The processes of one cell: started, found again, stopped."""

import contextlib
import json
import os
import signal
import socket
import subprocess
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from hydrohil.shared import cache
from hydrohil.shared.contract.messages import Answer
from hydrohil.shared.contract.topics import SERVICES
from hydrohil.shared.errors import HydrohilError
from hydrohil.shared.exit_status import EXIT_TRANSPORT, EXIT_TRIPPED, EXIT_USAGE
from hydrohil.shared.host.child import environment, python_module
from hydrohil.shared.host.process import draw_number
from hydrohil.shared.transport.bus import Bus, BusError
from hydrohil.shared.transport.endpoints import HERE, Network
from hydrohil.shared.trips.report import Document

LOOP = ("plant", "controller", "supervisor")
_STOP_S = 3.0
_POLL_S = 0.05
_READY_S = 60.0  # the first start after a change compiles


class CellError(HydrohilError):
    """The cell is not what was needed; the message says what to do. After a trip, `trip_report` says why and how."""

    exit_status = EXIT_TRANSPORT

    trip_report: Document | None = None
    trip_file: str = ""  # where the recorder has written it


class RefusedError(CellError):
    """A service, or the table of faults, refuses what was asked for."""


class NotConfirmedError(CellError):
    """After an emergency stop the plant has not reported zero current: cut the hydraulic supply."""


class UnqualifiedError(CellError):
    """The experiment's rate is above the one that this host is qualified for."""

    exit_status = EXIT_USAGE


class TrippedError(CellError):
    """The supervisor has tripped; nothing runs before a reset."""

    exit_status = EXIT_TRIPPED


class Place(NamedTuple):
    """Where a cell is on the network, and where its logs go."""

    cell: str
    port: int
    network: Network = HERE

    @property
    def words(self) -> list[str]:
        """The options that name this cell to a service or a command."""
        return ["--cell", self.cell, "--port", str(self.port), *self.network.words]

    def elsewhere(self, services: Iterable[str]) -> list[str]:
        """Those of `services` whose address is none of this machine's; behind a router no service has an address."""
        if self.network.router:
            return []
        return [service for service in services if not _on_this_machine(self.network.host(service))]

    @property
    def folder(self) -> Path:
        """Logs and process numbers of this cell."""
        return cache.folder() / "cells" / self.cell


def _on_this_machine(address: str) -> bool:
    """Whether a socket can listen on this address."""
    with socket.socket() as probe:
        try:
            probe.bind((address, 0))
        except OSError:
            return False
    return True


Processes = dict[str, subprocess.Popen[bytes]]


def start(place: Place, services: Iterable[str], *, with_parent: bool, extra: dict[str, list[str]]) -> Processes:
    """Start services in the background; their output goes to one log each."""
    place.folder.mkdir(parents=True, exist_ok=True)
    started = {}
    for service in services:
        line = [*python_module(f"hydrohil.services.{service}"), *place.words]
        line += ["--with-parent", str(os.getpid())] * with_parent + extra.get(service, [])
        with (place.folder / f"{service}.log").open("wb") as log:
            started[service] = subprocess.Popen(
                line,
                env=environment(),
                stdout=log,
                stderr=subprocess.STDOUT,
                stdin=subprocess.DEVNULL,
                start_new_session=not with_parent,
            )
    return started


def remember(place: Place, started: Processes) -> None:
    """Write down what `up` started, for `down`."""
    pids = {service: process.pid for service, process in started.items()}
    (place.folder / "cell.json").write_text(json.dumps({"port": place.port, "pids": pids}))


def remembered(place: Place) -> dict[str, int]:
    """Process numbers of what `up` started and still runs."""
    try:
        pids = json.loads((place.folder / "cell.json").read_text())["pids"]
    except (OSError, ValueError, KeyError):
        return {}
    return {service: pid for service, pid in pids.items() if _is_ours(pid, service)}


def _is_ours(pid: int, service: str) -> bool:
    try:
        line = Path(f"/proc/{pid}/cmdline").read_bytes().decode(errors="replace")
    except OSError:
        return False
    return f"hydrohil.services.{service}" in line


def stop(pids: Iterable[int]) -> None:
    """SIGTERM, and SIGKILL for what does not end within three seconds; returns when all have ended."""
    waiting = set(pids)
    for ending in (signal.SIGTERM, signal.SIGKILL):
        for pid in waiting:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, ending)
        deadline = time.monotonic() + _STOP_S
        while (waiting := {pid for pid in waiting if _lives(pid)}) and time.monotonic() < deadline:
            time.sleep(_POLL_S)


def _lives(pid: int) -> bool:
    with contextlib.suppress(ChildProcessError):
        os.waitpid(pid, os.WNOHANG)
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"


def last_words(place: Place, service: str) -> str:
    """Last line of a service's log."""
    with contextlib.suppress(OSError):
        lines = (place.folder / f"{service}.log").read_text(errors="replace").strip().splitlines()
        return lines[-1] if lines else ""
    return ""


@contextlib.contextmanager
def operator_bus(place: Place) -> Iterator[Bus]:
    """The operator's own place on the cell's network."""
    try:
        with Bus("operator", place.cell, place.port, draw_number(), place.network) as bus:
            yield bus
    except BusError as error:
        raise CellError(str(error)) from error


def ask(bus: Bus, service: str, verb: str, timeout_s: float = 3.0, **arguments: Any) -> dict[str, Any]:
    """The values of an accepted request; raises CellError with the service's reason, or if no answer comes."""
    answer: Answer | None = bus.ask(service, verb, arguments, timeout_s)
    if answer is None:
        raise CellError(f"the {service} does not answer: start it (`hydrohil {service}`) or see `hydrohil status`")
    if not answer.accepted:
        raise RefusedError(f"the {service} refuses to {verb}: {answer.reason}")
    values: dict[str, Any] = json.loads(answer.values)
    return values


def statuses(bus: Bus, services: Iterable[str] = SERVICES, timeout_s: float = 1.0) -> dict[str, dict[str, Any]]:
    """Status of every service that answers."""
    found = {}
    for service in services:
        answer = bus.ask(service, "status", {}, timeout_s)
        if answer is not None and answer.accepted:
            found[service] = json.loads(answer.values)
    return found


def await_ready(
    place: Place, bus: Bus, started: Processes | None = None, timeout_s: float = _READY_S
) -> dict[str, dict[str, Any]]:
    """Wait until plant, controller and supervisor are ready; raises CellError naming each service that is not, or has died."""
    deadline = time.monotonic() + timeout_s
    found: dict[str, dict[str, Any]] = {}
    while time.monotonic() < deadline:
        for service, process in (started or {}).items():
            if process.poll() is not None and service in LOOP:
                raise CellError(last_words(place, service) or f"the {service} ended with status {process.returncode}")
        found = statuses(bus, LOOP)
        if all(found.get(service, {}).get("ready") for service in LOOP):
            return found
        time.sleep(_POLL_S)
    missing = [service for service in LOOP if not found.get(service, {}).get("ready")]
    raise CellError(f"not ready within {timeout_s:g} s: {', '.join(missing)}; see {place.folder}/*.log")
