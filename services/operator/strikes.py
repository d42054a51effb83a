"""Faults of processes, on the wall clock: a service of this very cell is killed, frozen and thawed, slowed, or its host is loaded.

A process is signalled only if it answers as that service of this cell, now or when the trial began, and if it is one: the
number of a process that has ended may belong to another.
"""

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

from services.operator.cell import CellError, ask, statuses
from shared.bus import Bus
from shared.faults import PROCESSES, Fault

_BUSY = "import os, sys\nparent = int(sys.argv[1])\nwhile os.getppid() == parent:\n    sum(range(100_000))"
_SAID = "{kind} of the {target}"


class Done(NamedTuple):
    """What became of one fault."""

    fault: Fault
    words: str
    number: int | None = None  # sample of the plant when it was done


def pids(bus: Bus) -> dict[str, int]:
    """Process numbers of this cell's services, by their own word."""
    return {service: int(found["pid"]) for service, found in statuses(bus, PROCESSES).items() if "pid" in found}


def is_service(pid: int, service: str, cell: str) -> bool:
    """Whether a process is that service of that cell."""
    try:
        words = Path(f"/proc/{pid}/cmdline").read_bytes().decode(errors="replace").split("\0")
    except OSError:
        return False
    named = any(word in (f"services.{service}", service) for word in words)
    return named and cell in words


class Strikes:
    """The process faults of one trial, each carried out once at its time and undone at its end."""

    def __init__(self, bus: Bus, faults: Iterable[Fault]) -> None:
        """Find the processes; raises CellError if one that a fault names does not answer."""
        self._bus = bus
        self._waiting = sorted(faults, key=lambda fault: fault.at_s)
        self._pids = pids(bus) if self._waiting else {}
        self._undo: list[tuple[float, Fault, Callable[[], None]]] = []
        self.done: list[str] = []
        for fault in self._waiting:
            if fault.target in PROCESSES and fault.target not in self._pids:
                raise CellError(f"the {fault.target} does not answer, so it cannot be struck: start it (`hydrohil {fault.target}`)")

    @property
    def pending(self) -> bool:
        """Whether anything is still to do or to undo."""
        return bool(self._waiting or self._undo)

    def at(self, trial_s: float) -> None:
        """Do and undo what is due at this time of the trial."""
        while self._waiting and self._waiting[0].at_s <= trial_s:
            self._begin(self._waiting.pop(0), trial_s)
        for end_s, fault, undo in [entry for entry in self._undo if entry[0] <= trial_s]:
            self._undo.remove((end_s, fault, undo))
            undo()
            self.done.append(f"{trial_s:.3f} s: end of {fault.kind} {fault.target}")

    def end(self) -> None:
        """The trial is over: thaw what is frozen, end what loads the host."""
        for _, fault, undo in self._undo:
            undo()
            self.done.append(f"after the trial: end of {fault.kind} {fault.target}")
        self._undo.clear()
        self.done += [f"never: {fault.kind} {fault.target}, the trial ended before" for fault in self._waiting]
        self._waiting.clear()

    def _begin(self, fault: Fault, trial_s: float) -> None:
        try:
            undo = strike(self._bus, fault, self._pids)
        except CellError as error:
            self.done.append(f"{trial_s:.3f} s: {fault.kind} {fault.target} failed: {error}")
            return
        self.done.append(f"{trial_s:.3f} s: {fault.kind} {fault.target}" + (f" {fault.value:g}" if fault.value else ""))
        if undo is not None:
            self._undo.append((fault.at_s + fault.lasts_s if fault.lasts_s else float("inf"), fault, undo))


def strike(bus: Bus, fault: Fault, known: dict[str, int]) -> Callable[[], None] | None:
    """Carry one fault out now; returns what undoes it, if anything must. Raises CellError."""
    match fault.kind:
        case "kill":
            return _signal(bus, fault, known, signal.SIGKILL)
        case "freeze":
            _signal(bus, fault, known, signal.SIGSTOP)
            return lambda: _thaw(bus, fault, known)
        case "slow":
            ask(bus, fault.target, "inject", fault=fault._replace(at_s=0.0)._asdict())
            return None
        case _:
            return _load(int(fault.value))


def _signal(bus: Bus, fault: Fault, known: dict[str, int], number: int) -> None:
    pid = known[fault.target]
    if not is_service(pid, fault.target, bus.identity.cell):
        raise CellError(f"process {pid} is no {fault.target} of cell {bus.identity.cell!r}: it is left alone")
    os.kill(pid, number)


def _thaw(bus: Bus, fault: Fault, known: dict[str, int]) -> None:
    with contextlib.suppress(CellError, ProcessLookupError):  # it was killed meanwhile
        _signal(bus, fault, known, signal.SIGCONT)


def _load(count: int) -> Callable[[], None]:
    """Processes that never rest; they end with this one, however it ends."""
    started = [subprocess.Popen([sys.executable, "-c", _BUSY, str(os.getpid())]) for _ in range(count)]

    def end() -> None:
        for process in started:
            process.kill()
            process.wait()

    return end
