"""A router killed or frozen (row 7): its cell becomes safe unobserved; a mesh beside a router runs on.

While the router is dead no message of the plant reaches an observer. So the plant is asked afterwards: its status dates the last
cut of the gate, on its own grid and by the clock that all processes of one host share. Had the gate opened again and been cut
later, the last cut would be late. Every sample from after the cut that ever arrives must be safe.
"""

import os
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from random import Random
from statistics import median
from types import TracebackType
from typing import Any, NamedTuple

from hydrohil.cell.processes import CellError
from hydrohil.faulttest.motions import motion
from hydrohil.faulttest.observer import STEADY, Observation, hops, moved, safe, since
from hydrohil.faulttest.processes import FROZEN_S, WATCHED_S, confirmed, period_s
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import GateState
from hydrohil.shared.host.child import environment, python_module
from hydrohil.shared.transport.endpoints import LOOPBACK, Network
from hydrohil.shared.units import NS_PER_S

PORTS = 16  # beside the other cells of the fault test
RETURN_S = 10.0


class Router:
    """A router's process, started again when it is killed."""

    def __init__(self, endpoint: str, options: list[str]) -> None:
        """It listens at `endpoint`."""
        self._line = [
            *python_module("hydrohil.services.router"),
            "--listen",
            endpoint,
            "--with-parent",
            str(os.getpid()),
            *options,
        ]

    def start(self) -> None:
        """A new process; returns when it listens. Raises CellError."""
        self.process = subprocess.Popen(self._line, env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
        assert self.process.stdout is not None
        if not self.process.stdout.readline():
            raise CellError(f"the router ended with status {self.process.wait()}")

    def kill(self) -> None:
        """SIGKILL; returns when it is gone."""
        self.process.kill()
        self.process.wait()

    def __enter__(self) -> "Router":
        """Start."""
        self.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Kill the router, also if it is frozen."""
        self.kill()


def _router(rig: Rig) -> Router:
    return Router(_endpoint(rig), list(rig.extra.get("controller", ())))


def _endpoint(rig: Rig) -> str:
    return f"tcp/{LOOPBACK}:{rig.place.port + PORTS}"


@contextmanager
def _routed(rig: Rig) -> Iterator[tuple[Router, Rig]]:
    """A cell around a router of its own."""
    place = rig.place._replace(cell=f"{rig.place.cell}-routed", network=Network(router=_endpoint(rig)))
    with _router(rig) as router, Rig(place, rig.extra, rig.restarted) as cell:
        yield router, cell


def router_fault(rig: Rig, rng: Random, number: int, how: signal.Signals) -> Trial:
    """SIGKILL or SIGSTOP of the router while the valves move; it returns, then the cell is watched."""
    experiment = motion(number)
    with _routed(rig) as (router, cell):
        cell.start_moving(experiment, rng)
        revoked, lease_s = int(cell.status("plant")["revoked_arming_ids"]), cell.lease_s()
        bound_s = lease_s + period_s(experiment)
        cell.observer.listen()
        fault_ns = time.monotonic_ns()
        router.process.send_signal(how)
        cell.observer.listen_for(bound_s + rng.uniform(*FROZEN_S))
        returned_ns = time.monotonic_ns()
        if how == signal.SIGSTOP:
            router.process.send_signal(signal.SIGCONT)
        else:
            router.kill()
            router.start()
        cell.wait_for(lambda: len(since(cell.observer.listen().samples, returned_ns)) > STEADY, "samples of the plant", RETURN_S)
        observed = cell.observer.listen_for(WATCHED_S)
        trial = judged_by_cut(observed, fault_ns, cut_of(cell.status("plant")), bound_s)
        return confirmed(cell, trial, revoked, tripped=True)


class Cut(NamedTuple):
    """When the gate was last cut, by the plant's status; 0: in this trial it was not."""

    grid_ns: int
    clock_ns: int


def cut_of(status: dict[str, Any]) -> Cut:
    """From the plant's status."""
    return Cut(int(status["last_cut_ns"]), int(status["last_cut_clock_ns"]))


def judged_by_cut(observed: Observation, fault_ns: int, cut: Cut, bound_s: float) -> Trial:
    """The reaction to one fault by the plant's own status and the samples around the silence.

    If the cut is later against the grid than the samples before the fault were, the plant has overrun by the difference.
    """
    before = [late_ns(sample) for sample in observed.samples if sample.arrival_ns < fault_ns][-STEADY:]
    after = [sample for sample in observed.samples if sample.body.time_ns > cut.grid_ns]
    if not before or not after or cut.clock_ns < fault_ns:
        return Trial(False, "the gate was not cut after the fault", bound_s=bound_s)
    stood_s = max(0.0, cut.clock_ns - cut.grid_ns - median(before)) / NS_PER_S
    unsafe = sum(not safe(sample) for sample in after)
    words = f"{len(after)} samples received from after the cut, {unsafe} of them with current"
    moved_mm, force_n = moved(observed, fault_ns)
    reaction_s = (cut.clock_ns - fault_ns) / NS_PER_S
    trial = Trial(
        held=unsafe == 0,
        words=words,
        reaction_s=reaction_s,
        bound_s=bound_s,
        stalled_s=stood_s,
        moved_mm=moved_mm,
        force_n=force_n,
        hops=hops(observed, cut.clock_ns),
    )
    return trial if trial.in_time else trial._replace(held=False, words=f"zero current too late; {words}")


def late_ns(sample: Received) -> int:
    """Arrival against the plant's grid."""
    return sample.arrival_ns - int(sample.body.time_ns)


def mesh_runs_on(rig: Rig, rng: Random, number: int) -> Trial:
    """A router beside the fault test's own cell, which is a mesh, is killed: the trial goes on."""
    with _router(rig) as router:
        rig.start_moving(motion(number), rng)
        fault_ns = time.monotonic_ns()
        router.kill()
        observed = rig.observer.listen_for(WATCHED_S)
    cut = [event for event in since(observed.gates, fault_ns) if event.body.state == GateState.REVOKED]
    after = since(observed.samples, fault_ns)
    open_still = bool(after) and after[-1].body.gate == GateState.OPEN
    return Trial(open_still and not cut, f"{len(after)} samples in {WATCHED_S:g} s after the kill; {rig.state()}")
