"""How late this host wakes a process on an absolute grid: with the rig's own sleep, and by the machine's own means."""

import ctypes
import re
import shutil
import subprocess
import time
from typing import NamedTuple

from hydrohil.qualification.spread import Spread
from hydrohil.shared.host.clock import sleep_until
from hydrohil.shared.host.realtime import FIFO_PRIORITY
from hydrohil.shared.units import NS_PER_S

_CLOCK_MONOTONIC, _TIMER_ABSTIME = 1, 1
_NS_PER_US = 1000
_LONGEST_US = 100_000  # of cyclictest's histogram; of what is later only the maximum is known
_BUCKET = re.compile(r"^(\d+)\s+(\d+)$", re.MULTILINE)
_OVERFLOWS = re.compile(r"^# Histogram Overflows:\s+(\d+)", re.MULTILINE)
_MAXIMUM = re.compile(r"^# Max Latencies:\s+(\d+)", re.MULTILINE)


class Limit(NamedTuple):
    """The machine's own wake-ups, and who measured them."""

    us: Spread
    by: str


def lateness_us(period_ns: int, count: int) -> list[float]:
    """Lateness in us of a process that does nothing but sleep to an absolute grid, as the plant does."""
    late, due = [], time.monotonic_ns()
    for _ in range(count):
        due += period_ns
        late_ns = sleep_until(due)
        late.append(late_ns / _NS_PER_US)
        due += late_ns if late_ns > period_ns else 0
    return late


class _Timespec(ctypes.Structure):
    _fields_ = (("s", ctypes.c_long), ("ns", ctypes.c_long))


def nanosleep_lateness_us(period_ns: int, count: int) -> list[float]:
    """The same by clock_nanosleep with an absolute deadline, the kernel's own call. Raises OSError where it is refused."""
    libc = ctypes.CDLL(None)
    late, due = [], time.monotonic_ns()
    for _ in range(count):
        due += period_ns
        until = _Timespec(*divmod(due, NS_PER_S))
        if error := libc.clock_nanosleep(_CLOCK_MONOTONIC, _TIMER_ABSTIME, ctypes.byref(until), None):
            raise OSError(error, "clock_nanosleep")
        late_ns = time.monotonic_ns() - due
        late.append(late_ns / _NS_PER_US)
        due += late_ns if late_ns > period_ns else 0
    return late


def cyclictest(period_ns: int, count: int, *, fifo: bool) -> Limit | None:
    """What cyclictest measures in the rig's scheduling class; None where it is not installed, or does not run."""
    program = shutil.which("cyclictest")
    if program is None:
        return None
    scheduling = ["--policy=fifo", f"--priority={FIFO_PRIORITY}"] if fifo else ["--policy=other"]
    interval = f"--interval={period_ns // _NS_PER_US}"
    line = [program, "--quiet", "--mlockall", interval, f"--loops={count}", f"--histogram={_LONGEST_US}", *scheduling]
    ran = subprocess.run(line, capture_output=True, text=True, check=False)
    spread = histogram(ran.stdout) if ran.returncode == 0 else None
    return None if spread is None else Limit(spread, "cyclictest")


def histogram(text: str) -> Spread | None:
    """Percentiles of what cyclictest prints with --histogram, for one thread; None if it is no histogram."""
    buckets = [(int(late_us), int(count)) for late_us, count in _BUCKET.findall(text)]
    maximum = _MAXIMUM.search(text)
    beyond = sum(map(int, _OVERFLOWS.findall(text)))
    total = sum(count for _, count in buckets) + beyond
    if maximum is None or not total:
        return None
    worst = float(maximum.group(1))

    def rank(share: float) -> float:
        passed = 0
        for late_us, count in buckets:
            passed += count
            if passed > share * total:
                return float(late_us)
        return worst

    return Spread(rank(0.5), rank(0.99), rank(0.999), worst)
