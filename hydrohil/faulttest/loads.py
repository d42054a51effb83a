"""What must not matter to the loop (rows 6, 13, 16, 31): the way of a command with and without it, in one trial."""

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
from hydrohil.faulttest.observer import Heard, safe, since, unsafe_after
from hydrohil.faulttest.processes import WATCHED_S
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_TRIAL, Command, GateState
from hydrohil.shared.host.child import python_program
from hydrohil.shared.transport.bus import Bus

QUIET_S, LOADED_S = 1.2, 1.2
TURN_S = 0.25  # of load and of none, in turn
PARTS, FEWEST = 5, 20  # stretches of the quiet samples, and samples that make a median
START_S = 20.0  # of a recorder: it loads a large library
ALLOWED = 1.1  # ratio of medians, beyond what quiet stretches of the same trial already differ by
REQUESTS_PER_S, FRAMES_PER_S = 100, 10_000
STEP_FRAMES = 200
FULL_SWING = Command((3276, 3276, 3276))


def ways_ms(samples: Sequence[Received]) -> list[float]:
    """From each sample to the gate's taking its command, by the plant's own clock."""
    return [m.body.command_age_ns / 1e6 for m in samples if m.body.tick != NO_TRIAL and m.body.gate == GateState.OPEN]


def same_timing(quiet: Sequence[float], loaded: Sequence[float]) -> tuple[bool, str]:
    """Whether the median way is the same within what it differs by without any load, and both in words."""
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


def unharmed(heard: Heard, quiet: Sequence[Received], loaded: Sequence[Received]) -> Trial:
    """The trial ran on, with the same timing."""
    same, words = same_timing(ways_ms(quiet), ways_ms(loaded))
    cut = next((m.body for m in heard.gates if m.body.state == GateState.REVOKED), None)
    if cut is not None:
        return Trial(False, f"the gate has cut (cause {cut.cause}); {words}")
    return Trial(same, words)


def recorder_struck(rig: Rig, dice: Random, number: int, how: str) -> Trial:
    """Killed, frozen, or without room on its disk while it records."""
    folder = Path(tempfile.mkdtemp(prefix="hydrohil-faults-"))
    try:
        return _without_recorder(rig, dice, number, how, folder / "run.rrd")
    finally:
        rig.bus.ask("recorder", "finish", {}, 5.0)
        shutil.rmtree(folder, ignore_errors=True)


def _without_recorder(rig: Rig, dice: Random, number: int, how: str, path: Path) -> Trial:
    rig.calm()
    rig.await_(lambda: bool(rig.status("recorder")), "the recorder", START_S)
    rig.ask("recorder", "record", path=str(path), title="faults", summary_markdown="")
    rig.moving(motion(number), dice)
    if how == "frozen":
        return _compared(rig, lambda: _struck(rig, how, path))
    began_ns = time.monotonic_ns()
    rig.observer.listen_for(QUIET_S)
    blow_ns = time.monotonic_ns()
    with _struck(rig, how, path):
        heard = rig.observer.listen_for(LOADED_S)
    if how == "killed":
        rig.processes["recorder"].wait()
    samples = since(heard.samples, began_ns)
    quiet = [m for m in samples if m.arrival_ns < blow_ns]
    return unharmed(heard, quiet, since(samples, blow_ns))


@contextmanager
def _struck(rig: Rig, how: str, path: Path) -> Iterator[None]:
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
    """No file of a process may grow beyond `size`: what a full disk does to a writer, without filling one."""
    before = resource.prlimit(pid, resource.RLIMIT_FSIZE)
    resource.prlimit(pid, resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        with suppress(ProcessLookupError):
            resource.prlimit(pid, resource.RLIMIT_FSIZE, before)


def requests(rig: Rig, dice: Random, number: int) -> Trial:
    """100 status requests a second, to each service of the loop in turn."""
    rig.moving(motion(number), dice)
    return _compared(rig, lambda: _background(lambda: _asking(rig)))


def _compared(rig: Rig, load: Callable[[], AbstractContextManager[None]]) -> Trial:
    """Load and quiet in turn, so that what else the host does falls on both."""
    heard = rig.observer.heard
    quiet: list[Received] = []
    loaded: list[Received] = []
    for turn in range(round((QUIET_S + LOADED_S) / TURN_S)):
        from_ns = time.monotonic_ns()
        with load() if turn % 2 else nullcontext():
            heard = rig.observer.listen_for(TURN_S)
        (loaded if turn % 2 else quiet).extend(since(heard.samples, from_ns))
    return unharmed(heard, quiet, loaded)


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


def strangers(rig: Rig, dice: Random, number: int) -> Trial:
    """Valid frames of a foreign publisher that ask for full swing: counted, and nothing else."""
    with cells.operator_bus(rig.place) as stranger:
        rig.moving(motion(number), dice)
        before = discarded(rig)
        from_ns = time.monotonic_ns()
        flood = Flood(stranger)
        with _background(flood.catch_up):
            heard = rig.observer.listen_for(LOADED_S)
        counted = discarded(rig) - before
    samples = since(heard.samples, from_ns)
    open_still = bool(samples) and samples[-1].body.gate == GateState.OPEN
    swung = sum(FULL_SWING.dac_counts == m.body.dac_counts for m in samples)
    words = f"{flood.sent} foreign frames sent in {LOADED_S:g} s, {counted} counted, {swung} at the D/A; {rig.words()}"
    return Trial(open_still and counted > 0 and not swung, words)


class Flood:
    """Foreign frames at their rate, as far as this host lets one process send them."""

    def __init__(self, stranger: Bus) -> None:
        """It begins now."""
        self.sent, self._stranger, self._began = 0, stranger, time.monotonic()

    def catch_up(self) -> None:
        """What is due by now, a step at a time, so that whoever listens gets its turn."""
        due = min(int((time.monotonic() - self._began) * FRAMES_PER_S), self.sent + STEP_FRAMES)
        while self.sent < due:
            self._stranger.publish("controller/command", FULL_SWING)
            self.sent += 1
        time.sleep(0.0005)


def discarded(rig: Rig) -> int:
    """Commands that the plant has discarded, whatever the cause."""
    told = rig.status("plant")["link_stats"]["controller/command"]
    return sum(value for name, value in told.items() if name == "sender")


def hogged(rig: Rig, dice: Random, number: int) -> Trial:
    """Twice as many processes that never rest as there are processors: it runs on, or the lease ends it safely."""
    rig.moving(motion(number), dice)
    count = 2 * len(os.sched_getaffinity(0))
    blow_ns = time.monotonic_ns()
    hogs = [subprocess.Popen(python_program("while True: pass")) for _ in range(count)]
    try:
        rig.observer.listen_for(WATCHED_S)
    finally:
        for hog in hogs:
            hog.kill()
            hog.wait()
    heard = rig.observer.listen_for(WATCHED_S)
    counters = rig.status("plant")["counters"]
    resumed = unsafe_after(heard, blow_ns) if any(safe(m) for m in _cut(heard)) else 0
    words = (
        f"{count} hogs for {WATCHED_S:g} s: late {counters['late_commands']}, unanswered {counters['unanswered']}; {rig.words()}"
    )
    return Trial(resumed == 0, words + (f"; {resumed} samples with current after the cut" if resumed else ""))


def _cut(heard: Heard) -> list[Received]:
    """Samples from the gate's first cut on; none if it never cut."""
    at_ns = next((m.arrival_ns for m in heard.gates if m.body.state == GateState.REVOKED), None)
    return [] if at_ns is None else since(heard.samples, at_ns)
