"""How many faults a link may show: more than one a second under a bound identity is a cause to cut.

A bound identity is cell, sender and epoch of the stream that an inbox takes. What counts as a fault: a frame whose CRC is
wrong although its header still names it, a frame of it that comes again or too late (link faults), and a valid frame of its
sender under another epoch (an epoch conflict: two publishers, or one that was restarted). Every other frame is foreign: it
is counted by its cause, and is no fault of the link.
"""

from typing import NamedTuple

from hydrohil.shared.transport.acceptance import Acceptance
from hydrohil.shared.units import NS_PER_S

FAULTS_PER_S = 1  # one may come from a cable; a second one within a second is a cause


class ProtectionLimits(NamedTuple):
    """How long a fault is remembered, and how many of the newest."""

    window_ns: int = NS_PER_S
    kept: int = 8  # more count as eight


class ProtectionMemory(NamedTuple):
    """When the faults of the last window were counted, newest first."""

    at_ns: tuple[int, ...] = ()


def protection_step(memory: ProtectionMemory, limits: ProtectionLimits, faults: int, now_ns: int) -> ProtectionMemory:
    """Take `faults` new ones in at `now_ns`; a clock that was set back, as where lockstep begins, forgets what it cannot date."""
    recent = tuple(at for at in memory.at_ns if 0 <= now_ns - at < limits.window_ns)
    new = (now_ns,) * min(faults, limits.kept)
    return ProtectionMemory((new + recent)[: limits.kept])


class LinkObservation(NamedTuple):
    """Faults and epoch conflicts of one link within the last second."""

    faults: int
    epoch_conflicts: int


class Protection:
    """The faults and epoch conflicts of one inbox, on the clock of the service that drains it."""

    def __init__(self, acceptance: Acceptance, limits: ProtectionLimits) -> None:
        """No fault has been counted."""
        self._acceptance, self._limits = acceptance, limits
        self._faults = self._epoch_conflicts = ProtectionMemory()
        self._totals = LinkObservation(0, 0)  # at the last call of `observe`

    def observe(self, now_ns: int) -> LinkObservation:
        """Faults and epoch conflicts of the last second; those since the last call count as new at `now_ns`."""
        totals = LinkObservation(self._acceptance.link_faults, self._acceptance.epoch_conflicts)
        self._faults = protection_step(self._faults, self._limits, totals.faults - self._totals.faults, now_ns)
        self._epoch_conflicts = protection_step(
            self._epoch_conflicts, self._limits, totals.epoch_conflicts - self._totals.epoch_conflicts, now_ns
        )
        self._totals = totals
        return LinkObservation(len(self._faults.at_ns), len(self._epoch_conflicts.at_ns))


def worst(*links: LinkObservation) -> LinkObservation:
    """The most faults and the most epoch conflicts of any link: each identity has its own count."""
    return LinkObservation(max(link.faults for link in links), max(link.epoch_conflicts for link in links))
