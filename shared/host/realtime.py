"""What this host grants a control loop: real-time scheduling, locked memory, short idle latency."""

import contextlib
import ctypes
import gc
import os
import signal
import struct
import sys
from collections.abc import Iterator
from typing import NamedTuple

FIFO_PRIORITY = 49  # of controller and supervisor alike: command and permit are both needed within a lease
PLANT_PRIORITY = 50  # the plant takes an answer before the service that sent it goes on
_SWITCH_INTERVAL_S = 50e-6  # Python's 5 ms lets a busy thread hold a callback back for seconds
_MCL_CURRENT, _MCL_FUTURE = 1, 2
_PR_SET_PDEATHSIG, _PR_SET_TIMERSLACK = 1, 29
_held: list[int] = []  # the idle-latency request lasts while its file is open
_granted: list[int] = []  # the real-time priority; empty = none


class Granted(NamedTuple):
    """What was granted, for reports."""

    fifo: bool
    memory_locked: bool
    idle_latency: bool


def request_realtime(*, realtime: bool, priority: int = FIFO_PRIORITY) -> Granted:
    """Request what the host permits; call it before the transport starts its threads, which inherit it."""
    sys.setswitchinterval(_SWITCH_INTERVAL_S)
    libc = ctypes.CDLL(None, use_errno=True)
    libc.prctl(_PR_SET_TIMERSLACK, 1, 0, 0, 0)
    if not realtime:
        return Granted(False, False, False)
    return Granted(_fifo(priority), libc.mlockall(_MCL_CURRENT | _MCL_FUTURE) == 0, _idle_latency())


def _fifo(priority: int) -> bool:
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except (OSError, AttributeError):
        return False
    _granted.append(priority)
    return True


def pin_cpu(number: int, *, alone: bool) -> None:
    """Run on one CPU (`alone`), or on all but that one; where real-time scheduling was granted and there is a choice.

    So the data of the process stays in one CPU's cache. A cell with the next `number` takes the next CPU.
    """
    if not _granted:
        return
    allowed = sorted(os.sched_getaffinity(0))
    if len(allowed) > 1:
        one = {allowed[-1 - number % len(allowed)]}
        os.sched_setaffinity(0, one if alone else {*allowed} - one)


def is_fifo() -> bool:
    """Whether this process was granted real-time scheduling."""
    return bool(_granted)


def set_scheduling(clock: str) -> None:
    """Real-time scheduling on the real clock where it was granted; in lockstep it would starve every other process."""
    if clock != "real":
        return set_batch_scheduling()
    return _schedule("SCHED_FIFO", _granted[-1]) if _granted else _schedule("SCHED_OTHER", 0)


@contextlib.contextmanager
def without_realtime() -> Iterator[None]:
    """Work without a deadline: this thread gives up real-time scheduling meanwhile, so that no control loop waits for it."""
    if not _granted:
        yield
        return
    policy, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    try:
        yield
    finally:
        os.sched_setscheduler(0, policy, parameters)


def set_batch_scheduling() -> None:
    """Batch scheduling: a woken thread waits until the running one has finished, which saves context switches."""
    _schedule("SCHED_BATCH", 0)


def _schedule(policy: str, priority: int) -> None:
    """Set the policy of every thread of this process, where the system has it."""
    if not hasattr(os, policy):
        return
    for thread in os.listdir("/proc/self/task"):
        with contextlib.suppress(ProcessLookupError):
            os.sched_setscheduler(int(thread), getattr(os, policy), os.sched_param(priority))


def _idle_latency() -> bool:
    try:
        handle = os.open("/dev/cpu_dma_latency", os.O_WRONLY)
        os.write(handle, struct.pack("i", 0))
    except OSError:
        return False
    _held.append(handle)
    return True


def quiet_garbage_collection() -> None:
    """No garbage collection inside the loop: present objects are frozen, and `gc.collect` runs between trials."""
    gc.collect()
    gc.freeze()
    gc.disable()


def die_with_parent(parent: int) -> bool:
    """Ask the kernel for a SIGTERM when the starting process dies, however it dies; False if it is dead already."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)
    return os.getppid() == parent
