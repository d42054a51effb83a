"""How many faults a link may show: more than one a second under a bound identity is no accident.

A bound identity is cell, sender and epoch of the stream that an inbox takes. What counts against it: a frame whose CRC is
wrong although its header still names it, a frame of it that comes again or too late (link faults), and a valid frame of its
sender under another epoch (a rival: two publishers, or one that started anew). Everything else is a stranger: counted by
cause, and no fault of the link.
"""

from typing import NamedTuple

from hydrohil.shared.transport.acceptance import Acceptance
from hydrohil.shared.units import NS_PER_S

FAULTS_PER_S = 1  # one is an accident of a cable; a second one within a second is a cause


class ProtectionLimits(NamedTuple):
    """How long a fault is remembered, and how many of the newest."""

    window_ns: int = NS_PER_S
    kept: int = 8  # more are told as eight


class ProtectionMemory(NamedTuple):
    """When the faults of the last window were seen, newest first."""

    at_ns: tuple[int, ...] = ()


def protection_step(memory: ProtectionMemory, limits: ProtectionLimits, faults: int, now_ns: int) -> ProtectionMemory:
    """Take `faults` new ones in at `now_ns`; a clock that was set back, as where lockstep begins, forgets what it cannot date."""
    recent = tuple(at for at in memory.at_ns if 0 <= now_ns - at < limits.window_ns)
    new = (now_ns,) * min(faults, limits.kept)
    return ProtectionMemory((new + recent)[: limits.kept])


class LinkObservation(NamedTuple):
    """What one link has shown within the last second."""

    faults: int
    epoch_conflicts: int


class Protection:
    """The faults and epoch_conflicts of one inbox, by the clock of whoever drains it."""

    def __init__(self, acceptance: Acceptance, limits: ProtectionLimits) -> None:
        """Nothing seen."""
        self._acceptance, self._limits = acceptance, limits
        self._faults = self._epoch_conflicts = ProtectionMemory()
        self._told = LinkObservation(0, 0)  # totals at the last look

    def look(self, now_ns: int) -> LinkObservation:
        """Faults and epoch_conflicts of the last second, those included that came since the last look."""
        totals = LinkObservation(self._acceptance.link_faults, self._acceptance.epoch_conflicts)
        self._faults = protection_step(self._faults, self._limits, totals.faults - self._told.faults, now_ns)
        self._epoch_conflicts = protection_step(
            self._epoch_conflicts, self._limits, totals.epoch_conflicts - self._told.epoch_conflicts, now_ns
        )
        self._told = totals
        return LinkObservation(len(self._faults.at_ns), len(self._epoch_conflicts.at_ns))


def worst(*links: LinkObservation) -> LinkObservation:
    """The most faults and the most epoch_conflicts of any link: each identity has its own count."""
    return LinkObservation(max(link.faults for link in links), max(link.epoch_conflicts for link in links))
