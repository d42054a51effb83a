"""Faults of processes, on the wall clock: a service of this very cell is killed, frozen, slowed, or its host is loaded.

A process is signalled only if it answers as that service of this cell, now or when the trial began, and if it is one: the
number of a process that has ended may belong to another.
"""

import contextlib
import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterable
from pathlib import Path

from hydrohil.cell.processes import CellError, RefusedError, ask, statuses
from hydrohil.shared.contract.faults import PROCESSES, Fault, row_of
from hydrohil.shared.host.child import python_program
from hydrohil.shared.host.process import DEFAULT_CELL
from hydrohil.shared.transport.bus import Bus

LASTING = ("freeze", "hog")  # what the operator must undo

_BUSY = "import os, sys\nparent = int(sys.argv[1])\nwhile os.getppid() == parent:\n    sum(range(100_000))"
Undo = Callable[[], None]


def pids(bus: Bus) -> dict[str, int]:
    """Process numbers of this cell's services, from their status."""
    return {service: int(found["pid"]) for service, found in statuses(bus, PROCESSES).items() if "pid" in found}


def is_service(pid: int, service: str, cell: str) -> bool:
    """Whether a process is that service; and of that cell, where its command line names one."""
    try:
        words = Path(f"/proc/{pid}/cmdline").read_bytes().decode(errors="replace").split("\0")
    except OSError:
        return False
    named = any(word in (f"hydrohil.services.{service}", service) for word in words)
    return named and any(word in (cell, f"--cell={cell}") for word in (*words, DEFAULT_CELL))


class ProcessFaults:
    """The process faults of one trial, each carried out once at its time and undone at its end, or the trial's."""

    def __init__(self, bus: Bus, faults: Iterable[Fault], duration_s: float) -> None:
        """Find the processes; raises CellError if one that a fault names does not answer."""
        self._bus = bus
        self._waiting = [_ending(fault, duration_s) for fault in sorted(faults, key=lambda fault: fault.at_s)]
        self._pids = _answering(bus, self._waiting) if self._waiting else {}
        self._undo: list[tuple[float, Fault, Undo]] = []  # by the wall clock: a trial whose plant is frozen stands still
        self.done: list[str] = []

    @property
    def pending(self) -> bool:
        """Whether anything is still to do or to undo."""
        return bool(self._waiting or self._undo)

    def at(self, trial_s: float) -> None:
        """Do what is due at this time of the trial, undo what is over."""
        while self._waiting and self._waiting[0].at_s <= trial_s:
            self._begin(self._waiting.pop(0), trial_s)
        now_s = time.monotonic()
        for entry in [entry for entry in self._undo if entry[0] <= now_s]:
            self._undo.remove(entry)
            self._end(entry[1], entry[2], f"{entry[1].lasts_s:g} s later")

    def end(self) -> None:
        """The trial is over: thaw what is frozen, end what loads the host."""
        for _, fault, undo in self._undo:
            self._end(fault, undo, "after the trial")
        self.done += [f"{_words(fault)}: never, the trial ended before" for fault in self._waiting]
        self._undo, self._waiting = [], []

    def _begin(self, fault: Fault, trial_s: float) -> None:
        try:
            undo = carry_out(self._bus, fault, self._pids)
        except CellError as error:
            self.done.append(f"{_words(fault)}: failed at {trial_s:.3f} s: {error}")
            return
        self.done.append(f"{_words(fault)}: at {trial_s:.3f} s")
        if undo is not None:
            self._undo.append((time.monotonic() + fault.lasts_s, fault, undo))

    def _end(self, fault: Fault, undo: Undo, when: str) -> None:
        undo()
        self.done.append(f"{_words(fault)}: ended {when}")


def inject_now(bus: Bus, fault: Fault) -> str:
    """Inject into a cell that runs, and undo it when its time is over; what was done, in words. Raises CellError."""
    if fault.kind in LASTING and not fault.lasts_s:
        raise RefusedError(f"{fault.kind} needs a time (`--for SECONDS`): this command undoes it again")
    known = _answering(bus, (fault,))
    time.sleep(max(0.0, fault.at_s))
    undo = carry_out(bus, fault, known)
    if undo is None:
        return "done"
    try:
        time.sleep(fault.lasts_s)
    finally:
        undo()
    return f"done, and undone after {fault.lasts_s:g} s"


def carry_out(bus: Bus, fault: Fault, known: dict[str, int]) -> Undo | None:
    """Carry one fault out now; returns what undoes it, if anything must. Raises CellError."""
    match fault.kind:
        case "kill":
            _signal(bus, fault, known, signal.SIGKILL)
        case "freeze":
            _signal(bus, fault, known, signal.SIGSTOP)
            return lambda: _thaw(bus, fault, known)
        case "slow":
            ask(bus, fault.target, "inject", fault=fault._replace(at_s=0.0)._asdict())
        case "hog":
            return _hog(int(fault.value))
    return None


def _words(fault: Fault) -> str:
    return f"{fault.kind} {fault.target}" + (f" {fault.value:g} {row_of(fault).unit}" if fault.value else "")


def _ending(fault: Fault, duration_s: float) -> Fault:
    """`fault` with an end: the trial's, if it says none."""
    if fault.kind == "kill" or fault.lasts_s:
        return fault
    return fault._replace(lasts_s=max(0.0, duration_s - fault.at_s))


def _answering(bus: Bus, faults: Iterable[Fault]) -> dict[str, int]:
    """Process numbers; raises CellError if a service that a fault names does not answer."""
    known = pids(bus)
    for fault in faults:
        if fault.target in PROCESSES and fault.target not in known:
            raise CellError(f"the {fault.target} does not answer: nothing was done; start it (`hydrohil {fault.target}`)")
    return known


def _signal(bus: Bus, fault: Fault, known: dict[str, int], number: int) -> None:
    pid = known[fault.target]
    if not is_service(pid, fault.target, bus.identity.cell):
        raise CellError(f"process {pid} is no {fault.target} of cell {bus.identity.cell!r} on this host: it is left alone")
    os.kill(pid, number)


def _thaw(bus: Bus, fault: Fault, known: dict[str, int]) -> None:
    with contextlib.suppress(CellError, ProcessLookupError):  # it was killed meanwhile
        _signal(bus, fault, known, signal.SIGCONT)


def _hog(count: int) -> Undo:
    """Busy processes that load the host; they end with this one, however it ends."""
    started = [subprocess.Popen([*python_program(_BUSY), str(os.getpid())]) for _ in range(count)]

    def end() -> None:
        for process in started:
            process.kill()
            process.wait()

    return end
