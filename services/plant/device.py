"""What the plant's shell knows of the machine: read counts, write codes. The emulator is one, a real DAQ is another."""

from typing import NamedTuple, Protocol

from services.plant.config import PlantConfig
from shared.messages import NO_TRIAL, LinkCounts, Truth


class Reading(NamedTuple):
    """One pass over the converters."""

    encoder_counts: tuple[int, int, int, int, int]
    force_counts: int


class Timeline:
    """Simulated time, told to whoever emulates; a real DAQ lives in real time and ignores it."""

    def __init__(self) -> None:
        """Sub-step 0, no trial."""
        self.substep = 0
        self.number = 0
        self.tick = NO_TRIAL


class Device(Protocol):
    """Converters and counters of one machine."""

    def load(self, config: PlantConfig, seed: int, first_tick: int, ticks: int) -> None:
        """Prepare for a trial; a real DAQ checks that it can."""

    def watchdog(self, substeps: int) -> None:
        """Zero the D/A by itself if it is not written for this long."""

    def begin(self) -> None:
        """Take the declared initial state at the trial's first tick; a real DAQ moves nothing."""

    def read(self) -> Reading:
        """Counters and A/D now."""

    def write(self, codes: LinkCounts) -> None:
        """Codes to the D/A now."""

    def truth(self) -> Truth | None:
        """What only an emulator knows."""
