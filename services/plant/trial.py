"""When a trial's samples are due: the first sample is announced in advance, jitter is drawn, ticks are counted."""

from hydrohil.services.plant.config import PlantConfig, latch_substeps, tare_ticks
from hydrohil.services.plant.noise import sample_intervals
from hydrohil.shared.contract.envelope import Envelope, faults
from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL
from hydrohil.shared.units import SUBSTEP_NS


class Schedule:
    """Sample numbers to ticks and intervals of one loaded experiment."""

    def __init__(self, config: PlantConfig, envelope: Envelope | None = None) -> None:
        """Draw every interval of the trial; without an envelope there is no trial."""
        self.config, self.envelope = config, envelope
        self.period = config.sample_period_substeps
        self.latch = latch_substeps(config)
        self.first_tick = -tare_ticks(config)
        self.first_sample = NO_COMMAND
        self.ticks = 0
        self.faults: tuple[Fault, ...] = ()  # of the machine
        self._intervals: list[int] = []
        if envelope is not None:
            self.ticks = envelope.duration_ticks - self.first_tick
            self.faults = faults(envelope, "sensor", "actuator")
            drawn = sample_intervals(envelope.seed, self.first_tick, self.ticks, self.period, config.jitter_substeps)
            self._intervals = [int(value) for value in drawn]
        self.bias_ns = sum(self._intervals[: -self.first_tick]) * SUBSTEP_NS

    @property
    def lockstep(self) -> bool:
        """Whether a trial of this experiment waits for its answers instead of the wall clock."""
        return self.envelope is not None and self.envelope.clock == "lockstep"

    def announce(self, first_sample: int) -> None:
        """The trial begins at this sample number."""
        self.first_sample = first_sample

    def forget(self) -> None:
        """There is no trial any more."""
        self.first_sample = NO_COMMAND

    def tick(self, number: int) -> int:
        """Tick of a sample; NO_TRIAL outside the trial."""
        row = number - self.first_sample
        if self.first_sample == NO_COMMAND or not 0 <= row < self.ticks:
            return NO_TRIAL
        return row + self.first_tick

    def interval(self, tick: int) -> int:
        """Sub-steps from this tick's sample to the next."""
        return self.period if tick == NO_TRIAL else self._intervals[tick - self.first_tick]
