"""The wall clock that paces simulated time: an absolute grid that shifts by its owner's overrun."""

import time

from hydrohil.shared.units import SUBSTEP_NS

SLACK_NS = 500_000  # wake-ups later than this shift the rest of the grid; simulated time stood still meanwhile


def sleep_until(deadline_ns: int) -> int:
    """Sleep to an instant of the monotonic clock; returns how late the wake-up was, in ns."""
    while (left := deadline_ns - time.monotonic_ns()) > 0:
        time.sleep(left * 1e-9)
    return -left


class Grid:
    """Instants of simulated sub-steps on the monotonic clock."""

    def __init__(self) -> None:
        """Sub-step 0 is now."""
        self._origin_ns = time.monotonic_ns()

    def instant_ns(self, substep: int) -> int:
        """When a sub-step is due."""
        return self._origin_ns + substep * SUBSTEP_NS

    def substep_at(self, instant_ns: int) -> int:
        """The sub-step under way at an instant."""
        return (instant_ns - self._origin_ns) // SUBSTEP_NS

    def wait(self, substep: int) -> int:
        """Sleep until `substep` is due; what is overrun beyond the slack shifts the grid. Returns the lateness in ns."""
        late_ns = sleep_until(self.instant_ns(substep))
        if late_ns > SLACK_NS:
            self._origin_ns += late_ns
        return late_ns

    def restart_at(self, substep: int) -> None:
        """`substep` is due now."""
        self._origin_ns = time.monotonic_ns() - substep * SUBSTEP_NS
