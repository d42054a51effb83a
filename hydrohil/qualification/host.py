"""The properties of this host that matter to a control loop, each beside what is recommended."""

import os
import platform
from pathlib import Path
from typing import NamedTuple

from hydrohil.shared.host.realtime import PLANT_PRIORITY

IDLE = 0.25  # load per processor of a host that does little else
PROCESSES = 4  # plant, controller, supervisor, and everything else


class Found(NamedTuple):
    """One property of the host."""

    what: str
    found: str
    good: bool | None  # None = unknown
    advice: str  # what is recommended, and what it is worth


def found(granted: dict[str, bool], load: float, root: Path = Path("/")) -> tuple[Found, ...]:
    """Every property, by what a probe was granted, the load before it ran, and the files below `root`."""
    return (*_granted(granted), *_processors(root), _kernel(root, platform.version()), _machine(root), _busy(load))


def load_now() -> float:
    """Processes that were ready to run, averaged over the last minute."""
    return os.getloadavg()[0]


def _granted(granted: dict[str, bool]) -> tuple[Found, ...]:
    def row(name: str, what: str, advice: str) -> Found:
        held = granted.get(name, False)
        return Found(what, "granted" if held else "refused, or not asked for", held, advice)

    return (
        row(
            "fifo",
            "SCHED_FIFO",
            f"granted (root, or rtprio {PLANT_PRIORITY} in /etc/security/limits.conf): other work no longer delays the loop",
        ),
        row("memory_locked", "mlockall", "granted (memlock unlimited): no page fault in the loop"),
        row("idle_latency", "/dev/cpu_dma_latency", "may be written: processors do not fall asleep; about halves a round trip"),
    )


def _processors(root: Path) -> tuple[Found, ...]:
    affinity, cores = len(os.sched_getaffinity(0)), os.cpu_count() or 0
    system = root / "sys/devices/system/cpu"
    governors = sorted({_read(path) for path in system.glob("cpu[0-9]*/cpufreq/scaling_governor")})
    smt, isolated = _read(system / "smt/active"), _read(system / "isolated")
    return (
        Found(
            "processors", f"{affinity} of {cores}", affinity >= PROCESSES, f"{PROCESSES} or more: one a service, one for the rest"
        ),
        Found(
            "frequency governor",
            ", ".join(governors) or "unknown",
            set(governors) == {"performance"} if governors else None,
            "performance: the clock does not have to rise first",
        ),
        Found(
            "SMT",
            {"0": "off", "1": "on"}.get(smt, "unknown"),
            {"0": True, "1": False}.get(smt),
            "off: a sibling shares caches and units with the loop",
        ),
        Found(
            "isolated processors", isolated or "none", bool(isolated), "isolcpus= for the services: nothing else is placed there"
        ),
    )


def _kernel(root: Path, version: str) -> Found:
    realtime = _read(root / "sys/kernel/realtime") == "1" or "PREEMPT_RT" in version
    kinds = ("PREEMPT_DYNAMIC", "PREEMPT")
    kind = "PREEMPT_RT" if realtime else next((kind for kind in kinds if kind in version), "no preemption named")
    return Found("kernel", f"{platform.release()}, {kind}", realtime, "PREEMPT_RT: bounds the wake-up of a real-time process")


def _machine(root: Path) -> Found:
    guest = "hypervisor" in _read(root / "proc/cpuinfo").split()
    return Found(
        "machine",
        "virtual" if guest else "bare metal",
        not guest,
        "bare metal: a hypervisor stalls its guests unnoticed",
    )


def _busy(load: float) -> Found:
    cores = len(os.sched_getaffinity(0))
    return Found("load before", f"{load:.1f} on {cores} processors", load <= IDLE * cores, "idle, or with the load it will have")


def _read(path: Path) -> str:
    try:
        return path.read_text().strip()
    except OSError:
        return ""
