"""Loads that must not change the loop (rows 6, 13, 16, 31): the latency of commands with and without them, in one trial."""

import os
import resource
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from pathlib import Path
from random import Random
from statistics import median

from hydrohil.cell import processes as cells
from hydrohil.faulttest.motions import motion
from hydrohil.faulttest.observer import Observation, safe, since, unsafe_after
from hydrohil.faulttest.processes import WATCHED_S
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_TRIAL, Command, GateState
from hydrohil.shared.host.child import python_program
from hydrohil.shared.transport.bus import Bus

QUIET_S, LOADED_S = 1.2, 1.2
TURN_S = 0.25  # with the load and without it, in turn
PARTS, FEWEST = 5, 20  # stretches of the quiet samples, and samples that make a median
START_S = 20.0  # of a recorder: it loads a large library
ALLOWED = 1.1  # ratio of medians, beyond what quiet stretches of the same trial already differ by
REQUESTS_PER_S, FRAMES_PER_S = 100, 10_000
STEP_FRAMES = 200
FULL_SWING = Command((3276, 3276, 3276))


def latencies_ms(samples: Sequence[Received]) -> list[float]:
    """From each sample to the gate's acceptance of its command, in ms, by the plant's own clock."""
    return [m.body.command_age_ns / 1e6 for m in samples if m.body.tick != NO_TRIAL and m.body.gate == GateState.OPEN]


def compare_timing(quiet: Sequence[float], loaded: Sequence[float]) -> tuple[bool, str]:
    """Whether the median latency is the same within its spread without load; and both in words."""
    if len(quiet) < PARTS * FEWEST or len(loaded) < FEWEST:
        return False, "the gate was not open long enough to compare"
    size = len(quiet) // PARTS
    parts = [median(quiet[i * size : (i + 1) * size]) for i in range(PARTS)]
    noise = max(parts) / min(parts)
    ratio = median(loaded) / median(quiet)
    words = (
        f"sample to accepted, median and worst: {median(quiet):.2f} and {max(quiet):.1f} ms without, {median(loaded):.2f} and "
        f"{max(loaded):.1f} ms with: ratio {ratio:.2f}, allowed {ALLOWED * noise:.2f}"
    )
    return ratio <= ALLOWED * noise, words


def timing_unchanged(observed: Observation, quiet: Sequence[Received], loaded: Sequence[Received]) -> Trial:
    """Whether the trial ran on with the same timing."""
    same, words = compare_timing(latencies_ms(quiet), latencies_ms(loaded))
    cut = next((m.body for m in observed.gates if m.body.state == GateState.REVOKED), None)
    if cut is not None:
        return Trial(False, f"the gate has cut (cause {cut.cause}); {words}")
    return Trial(same, words)


def recorder_fault(rig: Rig, rng: Random, number: int, how: str) -> Trial:
    """Killed, frozen, or without room on its disk while it records."""
    folder = Path(tempfile.mkdtemp(prefix="hydrohil-faults-"))
    try:
        return _during_recording(rig, rng, number, how, folder / "run.rrd")
    finally:
        rig.bus.ask("recorder", "finish", {}, 5.0)
        shutil.rmtree(folder, ignore_errors=True)


def _during_recording(rig: Rig, rng: Random, number: int, how: str, path: Path) -> Trial:
    rig.reset()
    rig.wait_for(lambda: bool(rig.status("recorder")), "the recorder", START_S)
    rig.ask("recorder", "record", path=str(path), title="faults", summary_markdown="")
    rig.start_moving(motion(number), rng)
    if how == "frozen":
        return _compared(rig, lambda: _recorder_broken(rig, how, path))
    began_ns = time.monotonic_ns()
    rig.observer.listen_for(QUIET_S)
    fault_ns = time.monotonic_ns()
    with _recorder_broken(rig, how, path):
        observed = rig.observer.listen_for(LOADED_S)
    if how == "killed":
        rig.processes["recorder"].wait()
    samples = since(observed.samples, began_ns)
    quiet = [m for m in samples if m.arrival_ns < fault_ns]
    return timing_unchanged(observed, quiet, since(samples, fault_ns))


@contextmanager
def _recorder_broken(rig: Rig, how: str, path: Path) -> Iterator[None]:
    recorder = rig.processes["recorder"]
    if how == "killed":
        recorder.kill()
        yield
    elif how == "frozen":
        recorder.send_signal(signal.SIGSTOP)
        yield
        recorder.send_signal(signal.SIGCONT)
    else:
        with _full(recorder.pid, path.stat().st_size):
            yield


@contextmanager
def _full(pid: int, size: int) -> Iterator[None]:
    """No file of a process may grow beyond `size`: the effect of a full disk on a writer, without filling one."""
    before = resource.prlimit(pid, resource.RLIMIT_FSIZE)
    resource.prlimit(pid, resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        with suppress(ProcessLookupError):
            resource.prlimit(pid, resource.RLIMIT_FSIZE, before)


def requests(rig: Rig, rng: Random, number: int) -> Trial:
    """100 status requests a second, to each service of the loop in turn."""
    rig.start_moving(motion(number), rng)
    return _compared(rig, lambda: _background(lambda: _asking(rig)))


def _compared(rig: Rig, load: Callable[[], AbstractContextManager[None]]) -> Trial:
    """With and without load in turn, so that other work on the host affects both alike."""
    observed = rig.observer.observed
    quiet: list[Received] = []
    loaded: list[Received] = []
    for turn in range(round((QUIET_S + LOADED_S) / TURN_S)):
        from_ns = time.monotonic_ns()
        with load() if turn % 2 else nullcontext():
            observed = rig.observer.listen_for(TURN_S)
        (loaded if turn % 2 else quiet).extend(since(observed.samples, from_ns))
    return timing_unchanged(observed, quiet, loaded)


@contextmanager
def _background(step: Callable[[], object]) -> Iterator[None]:
    """`step` again and again in a thread of its own."""
    over = threading.Event()

    def repeat() -> None:
        while not over.is_set():
            step()

    thread = threading.Thread(target=repeat)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def _asking(rig: Rig) -> None:
    for service in cells.LOOP:
        rig.bus.ask(service, "status", {}, 1.0)
        time.sleep(1.0 / REQUESTS_PER_S)


def foreign_frames(rig: Rig, rng: Random, number: int) -> Trial:
    """Valid frames of a foreign publisher that ask for full swing: counted, and nothing else."""
    with cells.operator_bus(rig.place) as foreign:
        rig.start_moving(motion(number), rng)
        before = discarded(rig)
        from_ns = time.monotonic_ns()
        flood = Flood(foreign)
        with _background(flood.catch_up):
            observed = rig.observer.listen_for(LOADED_S)
        counted = discarded(rig) - before
    samples = since(observed.samples, from_ns)
    open_still = bool(samples) and samples[-1].body.gate == GateState.OPEN
    swung = sum(FULL_SWING.dac_counts == m.body.dac_counts for m in samples)
    words = f"{flood.sent} foreign frames sent in {LOADED_S:g} s, {counted} counted, {swung} at the D/A; {rig.state()}"
    return Trial(open_still and counted > 0 and not swung, words)


class Flood:
    """Foreign frames at their rate, as far as this host lets one process send them."""

    def __init__(self, foreign: Bus) -> None:
        """The flood begins now."""
        self.sent, self._foreign, self._began = 0, foreign, time.monotonic()

    def catch_up(self) -> None:
        """Send what is due by now, in small steps, so that other threads get the processor."""
        due = min(int((time.monotonic() - self._began) * FRAMES_PER_S), self.sent + STEP_FRAMES)
        while self.sent < due:
            self._foreign.publish("controller/command", FULL_SWING)
            self.sent += 1
        time.sleep(0.0005)


def discarded(rig: Rig) -> int:
    """Commands that the plant has discarded because of their sender."""
    counts = rig.status("plant")["link_stats"]["controller/command"]
    return sum(value for name, value in counts.items() if name == "sender")


def hogged(rig: Rig, rng: Random, number: int) -> Trial:
    """Twice as many busy processes as there are processors: the trial goes on, or the lease ends it safely."""
    rig.start_moving(motion(number), rng)
    count = 2 * len(os.sched_getaffinity(0))
    fault_ns = time.monotonic_ns()
    hogs = [subprocess.Popen(python_program("while True: pass")) for _ in range(count)]
    try:
        rig.observer.listen_for(WATCHED_S)
    finally:
        for hog in hogs:
            hog.kill()
            hog.wait()
    observed = rig.observer.listen_for(WATCHED_S)
    counters = rig.status("plant")["counters"]
    resumed = unsafe_after(observed, fault_ns) if any(safe(m) for m in _cut(observed)) else 0
    late = f"late {counters['late_commands']}, unanswered {counters['unanswered']}"
    words = f"{count} hogs for {WATCHED_S:g} s: {late}; {rig.state()}"
    return Trial(resumed == 0, words + (f"; {resumed} samples with current after the cut" if resumed else ""))


def _cut(observed: Observation) -> list[Received]:
    """Samples from the gate's first cut on; none if it never cut."""
    at_ns = next((m.arrival_ns for m in observed.gates if m.body.state == GateState.REVOKED), None)
    return [] if at_ns is None else since(observed.samples, at_ns)
