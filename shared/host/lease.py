"""The lease of permits and commands: 20 ms as industrial arms use, or three times this host's worst wake-up.

Two seconds rarely contain a host's worst wake-up. So the lease grows with later ones while nothing is armed, never in a trial.
"""

import time

from hydrohil.shared.host.wakeups import Probe
from hydrohil.shared.units import NS_PER_S

MEASURED_S = 2.0  # of wake-ups before a lease is chosen
MIN_LEASE_NS, MAX_LEASE_NS = 20_000_000, 200_000_000
LEASE_PER_LATENESS = 3
UNCHOSEN = 0


def required_lease_ns(worst_ns: int) -> int:
    """The lease for a host whose worst wake-up is this late; more than MAX_LEASE_NS is not given."""
    return max(MIN_LEASE_NS, LEASE_PER_LATENESS * worst_ns)


class LeaseChoice:
    """Measures wake-ups, chooses after two seconds, and raises its choice between trials."""

    def __init__(self, probe: Probe | None = None, *, fixed: bool) -> None:
        """A fixed lease was chosen on the command line; a probe measures since before this process was ready."""
        self.chosen = fixed
        self._fixed, self._probe = fixed, probe
        self._lease_ns = MIN_LEASE_NS
        self._until_ns = time.monotonic_ns() + int(MEASURED_S * NS_PER_S)
        self._required_ns = MIN_LEASE_NS

    def after(self, late_ns: int, *, armed: bool) -> int:
        """Take one wake-up's lateness in; the lease in ns when it is chosen or raised now, otherwise UNCHOSEN."""
        if self._fixed:
            return UNCHOSEN
        self._take(late_ns)
        if armed or not self._measured():
            return UNCHOSEN
        lease_ns = min(self._required_ns, MAX_LEASE_NS)
        if self.chosen and lease_ns <= self._lease_ns:
            return UNCHOSEN
        self.chosen, self._lease_ns = True, lease_ns
        return lease_ns

    def _take(self, late_ns: int) -> None:
        self._required_ns = max(self._required_ns, required_lease_ns(late_ns))

    def _measured(self) -> bool:
        """Whether two seconds of wake-ups are in: the probe's, or this process's own."""
        if self._probe is None:
            return time.monotonic_ns() >= self._until_ns
        worst_ns = self._probe.result()
        if worst_ns is None:
            return False
        self._take(worst_ns)
        self._until_ns, self._probe = time.monotonic_ns(), None
        return True
