"""The plant's time: sub-steps on the wall clock's grid, or simulated time that waits for the answers in lockstep."""

import time

from hydrohil.services.plant.config import PlantConfig
from hydrohil.services.plant.device import Timeline
from hydrohil.services.plant.trial import Schedule
from hydrohil.shared.contract.messages import NO_TRIAL
from hydrohil.shared.host.clock import Grid
from hydrohil.shared.units import SUBSTEP_NS


class PlantClock:
    """When the next sample and its latch are due, and what time it is."""

    def __init__(self, timeline: Timeline) -> None:
        """Sub-step 0 is now; no trial is loaded."""
        self.timeline, self.grid = timeline, Grid()
        self.schedule = Schedule(PlantConfig())
        self.due = 0  # sub-step of the next sample

    def load(self, schedule: Schedule) -> None:
        """Take another experiment's schedule; the next sample is due now.

        The sample of the trial before is answered no more, and in lockstep the plant may be waiting for that.
        """
        self.schedule = schedule
        self.timeline.tick = NO_TRIAL
        self.grid.restart_at(self.due)

    @property
    def lockstep(self) -> bool:
        """Whether a trial runs that waits for its answers instead of the wall clock."""
        return self.schedule.lockstep and self.timeline.tick != NO_TRIAL

    @property
    def due_ns(self) -> int:
        """Simulated time of the sample, in ns."""
        return self.due * SUBSTEP_NS

    @property
    def latch(self) -> int:
        """Sub-step at which this sample's command takes effect."""
        return self.due + self.schedule.latch

    @property
    def latch_delay_ns(self) -> int:
        """From a sample to its latch, in ns."""
        return self.schedule.latch * SUBSTEP_NS

    @property
    def period_ns(self) -> int:
        """Nominal time between two samples, in ns."""
        return self.schedule.period * SUBSTEP_NS

    def now_ns(self) -> int:
        """The clock by which ages are judged: the wall's, or simulated time in lockstep; in ns."""
        return self.timeline.substep * SUBSTEP_NS if self.lockstep else time.monotonic_ns()

    def advance_to(self, substep: int) -> None:
        """Simulated time goes forward to `substep`, never back."""
        self.timeline.substep = max(self.timeline.substep, substep)

    def next_sample(self) -> None:
        """The sample is over; the next one is due an interval later."""
        self.due += self.schedule.interval(self.timeline.tick)
        self.timeline.number += 1
