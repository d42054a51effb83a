"""Heralds: the last sample once more, shortly before the next, so that its way and what answers it have just been used."""

import time

from shared.bus import Bus
from shared.clock import Grid, sleep_until
from shared.messages import Sample

LEADS_NS = (600_000, 300_000)  # before the sample: the first fetches what was displaced, the second finds it fetched
REST = 200  # samples without heralds after one that was not answered in time: processors are short


class Heralds:
    """Sends them while there is time for it, and while whoever answers keeps up."""

    def __init__(self, bus: Bus, grid: Grid, *, wanted: bool) -> None:
        """None sent."""
        self._bus, self._grid = bus, grid
        self._wanted, self._resting = wanted, 0
        self.sent = 0

    def send(self, due: int, last: Sample) -> None:
        """Those of the sample that is due at sub-step `due`, each at its instant; one whose instant has passed is left out."""
        if not self._wanted or self._resting:
            return
        for lead_ns in LEADS_NS:
            instant_ns = self._grid.instant_ns(due) - lead_ns
            if time.monotonic_ns() < instant_ns:
                sleep_until(instant_ns)
                self._bus.publish("plant/herald", last, (last.number, last.time_ns))
                self.sent += 1

    def heed(self, *, answered: bool) -> None:
        """What became of a sample at its latch."""
        self._resting = max(0, self._resting - 1) if answered else REST
