"""Warm-up frames: the last sample once more, shortly before the next, so that caches hold what sends and answers it."""

import time

from hydrohil.shared.contract.messages import Sample
from hydrohil.shared.host.clock import Grid, sleep_until
from hydrohil.shared.transport.bus import Bus

LEADS_NS = (400_000, 200_000)  # before the sample: the first frame fills the caches, the second uses them
SLOW = 6  # an answer is slow if it comes after the sixth part of the time until the latch
REST = 200  # samples without warm-up frames once two answers in a row were slow: processors are short


class Warmups:
    """Sends warm-up frames while there is time and while the answers are quick."""

    def __init__(self, bus: Bus, grid: Grid, *, enabled: bool) -> None:
        """None is sent yet; a plant with `--no-warmup` never sends one."""
        self._bus, self._grid = bus, grid
        self._enabled, self._resting, self._slow = enabled, 0, False
        self.sent = 0

    def send(self, due: int, last: Sample) -> None:
        """Send the frames that precede the sample due at sub-step `due`, each at its instant, or not if that has passed."""
        if not self._enabled or self._resting:
            return
        for lead_ns in LEADS_NS:
            instant_ns = self._grid.instant_ns(due) - lead_ns
            if time.monotonic_ns() < instant_ns:
                sleep_until(instant_ns)
                self._bus.publish("plant/warmup", last, (last.number, last.time_ns))
                self.sent += 1

    def observe(self, after_ns: int, latch_ns: int) -> None:
        """Take in how long after its sample an answer came, in ns; one that was missing at the latch counts as that long."""
        before, self._slow = self._slow, after_ns * SLOW > latch_ns
        self._resting = REST if self._slow and before else max(0, self._resting - 1)
