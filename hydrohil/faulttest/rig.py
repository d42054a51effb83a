"""The fault test's own cell: brought up when first needed, repaired after every trial, stopped at the end."""

import math
import os
import signal
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from random import Random
from types import TracebackType
from typing import Any

from hydrohil.cell import processes as cells
from hydrohil.cell.session import arm, load
from hydrohil.experiment.experiment import Experiment
from hydrohil.faulttest.observer import ZERO, Observer
from hydrohil.shared.contract.topics import SERVICES
from hydrohil.shared.transport.bus import Bus

PATIENCE_S = 5.0
OBSERVER_PRIORITY = 60  # above the services: it needs only microseconds a sample
RETRIES = 3
LOCKSTEP_LEASE_MS = "20"
SETTLE_S = 0.3  # from tick 0 until the motion has begun
PHASES_S = 0.6  # the fault begins at a random instant of this interval
HOLD_EVERY_S, RECOVER_S = 0.05, 0.5  # a hold-to-run request is repeated, until the force is gone
_POLL_S = 0.002
Extra = dict[str, list[str]]


def lockstep_extra(extra: Extra) -> Extra:
    """Options of a cell for lockstep: its lease passes in simulated time, so that of industrial arms suffices on any host."""
    common = list(extra.get("controller", ()))
    return extra | {"plant": [*common, "--permit-ttl-ms", LOCKSTEP_LEASE_MS]}


def raise_priority() -> bool:
    """Real-time scheduling for every thread of this process, none for what it starts; False if the host refuses."""
    try:
        for thread in os.listdir("/proc/self/task"):
            os.sched_setscheduler(int(thread), os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(OBSERVER_PRIORITY))
    except OSError:
        return False
    return True


class Rig:
    """A cell, its processes and its observer."""

    def __init__(self, place: cells.Place, extra: Extra, restarted: Callable[[str], None]) -> None:
        """Nothing is started before it is needed; `restarted` gets a line for each trial that is started again."""
        self.place, self.extra, self.restarted = place, extra, restarted
        self.processes: cells.Processes = {}
        self._stack = ExitStack()
        self._bus: Bus | None = None
        self._observer: Observer | None = None
        self.lease_ms = math.nan  # of the cell, once it is up
        self.prompt = False  # whether the host gives the observer real-time scheduling

    def __enter__(self) -> "Rig":
        """Return the rig; nothing is started yet."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Stop every process that was started."""
        cells.stop(process.pid for process in self.processes.values())
        self._stack.close()

    @property
    def bus(self) -> Bus:
        """The operator's place in the cell; the first use brings the cell up. Raises CellError."""
        if self._bus is None:
            self.processes = cells.start(self.place, SERVICES, with_parent=True, extra=self.extra)
            self._bus = self._stack.enter_context(cells.operator_bus(self.place))
            found = cells.await_ready(self.place, self._bus, self.processes)
            self.lease_ms = float(found["plant"]["lease_ms"])
            if "--no-realtime" not in self.extra.get("plant", ()):
                self.prompt = raise_priority()
        return self._bus

    @property
    def observer(self) -> Observer:
        """The observer of the cell."""
        if self._observer is None:
            self._observer = Observer(self.bus)
        return self._observer

    def ask(self, service: str, verb: str, **arguments: Any) -> dict[str, Any]:
        """The values of an accepted request. Raises CellError."""
        return cells.ask(self.bus, service, verb, **arguments)

    def status(self, service: str) -> dict[str, Any]:
        """The status of a service; empty without an answer."""
        return cells.statuses(self.bus, (service,)).get(service, {})

    def restart_ended(self) -> None:
        """Start again whatever has ended and wait until every service is ready."""
        gone = [service for service, process in self.processes.items() if process.poll() is not None]
        self.processes |= cells.start(self.place, gone, with_parent=True, extra=self.extra)
        cells.await_ready(self.place, self.bus, self.processes)

    def reset(self) -> None:
        """Disarm and reset, whatever came before; a force that remains is unloaded first. Raises CellError."""
        deadline = time.monotonic() + PATIENCE_S
        while True:
            try:
                self.bus.ask("supervisor", "stop", {}, 1.0)
                self.ask("plant", "reset")
                self.ask("supervisor", "reset")
                return
            except cells.CellError:
                if time.monotonic() > deadline:
                    raise
                self.recover(RECOVER_S)

    def recover(self, seconds: float) -> int:
        """Hold to run for `seconds`, then release; returns the instant of the release in ns. A refused hold ends at once."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            answer = self.bus.ask("supervisor", "recover", {}, 1.0)
            self.observer.listen_for(HOLD_EVERY_S)
            if answer is None or not answer.accepted:
                break
        released_ns = time.monotonic_ns()
        self.bus.ask("supervisor", "release", {}, 1.0)
        return released_ns

    def restart_all(self) -> None:
        """Stop every process of the cell and start new ones."""
        self.thaw()
        cells.stop(process.pid for process in self.processes.values())
        self.processes = cells.start(self.place, SERVICES, with_parent=True, extra=self.extra)
        cells.await_ready(self.place, self.bus, self.processes)

    def start_trial(self, experiment: Experiment, seed: int, clock: str = "real") -> int:
        """Load, arm and start; the number of the run. Raises CellError."""
        self.reset()
        run = load(self.bus, experiment, seed, clock, unqualified=True).run  # faults are tried on any host
        arm(self.bus)
        self.observer.clear()
        self.ask("supervisor", "start")
        return run

    def start_moving(self, experiment: Experiment, rng: Random) -> None:
        """A trial whose valves move, at a random phase; one that ends before the fault is reported and started again."""
        for _ in range(RETRIES):
            try:
                return self._start_moving(experiment, rng)
            except cells.CellError as error:
                self.restarted(f"started again: {error}")
        return self._start_moving(experiment, rng)

    def _start_moving(self, experiment: Experiment, rng: Random) -> None:
        self.start_trial(experiment, rng.randrange(1 << 32))
        self.wait_for(lambda: self._tick() >= 0, "the trial's first tick")
        self.observer.listen_for(SETTLE_S + rng.uniform(0.0, PHASES_S))
        self.wait_for(self._driven, "a valve off zero")
        time.sleep(rng.uniform(0.0, 0.001 * experiment.plant.sample_period_substeps * 0.05))  # any phase of the period
        self.observer.listen()

    def _tick(self) -> int:
        samples = self.observer.listen().samples
        return samples[-1].body.tick if samples else -1

    def _driven(self) -> bool:
        return bool(self.observer.listen().samples[-1].body.dac_counts != ZERO)

    def wait_for(self, condition: Callable[[], bool], what: str, patience_s: float = PATIENCE_S) -> None:
        """Wait until `condition`. Raises CellError that names what did not come, and the state of the cell."""
        deadline = time.monotonic() + patience_s
        while not condition():
            if time.monotonic() > deadline:
                raise cells.CellError(f"{what} did not come within {patience_s:g} s: {self.state()}")
            time.sleep(_POLL_S)

    def state(self) -> str:
        """State of supervisor and gate in words."""
        supervisor, plant = self.status("supervisor"), self.status("plant")
        return f"{supervisor.get('mode')}, {supervisor.get('words') or 'no trip'}; last cut {plant.get('last_cut')}"

    def lease_s(self) -> float:
        """The plant's lease; while armed it does not change."""
        self.lease_ms = float(self.status("plant")["lease_ms"])
        return self.lease_ms / 1000.0

    def thaw(self) -> None:
        """Send SIGCONT to every process."""
        for process in self.processes.values():
            with suppress(ProcessLookupError):
                process.send_signal(signal.SIGCONT)
