"""What the plant's shell knows of the machine: read counts, write codes. The emulator is one, a real DAQ is another."""

from typing import NamedTuple, Protocol

from hydrohil.services.plant.config import PlantConfig
from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.contract.messages import NO_TRIAL, GroundTruth, LinkCounts

Faults = tuple[Fault, ...]


class Reading(NamedTuple):
    """One pass over the converters."""

    encoder_counts: tuple[int, int, int, int, int]
    force_counts: int


class Timeline:
    """Simulated time, which an emulator follows; a real DAQ ignores it."""

    def __init__(self) -> None:
        """Sub-step 0, no trial."""
        self.substep = 0
        self.number = 0
        self.tick = NO_TRIAL


class Device(Protocol):
    """Converters and counters of one machine."""

    def refuses(self, faults: Faults) -> str:
        """Why it cannot break like this, one line, "" if it can. A real device refuses every fault."""

    def load(self, config: PlantConfig, seed: int, first_tick: int, ticks: int, faults: Faults) -> None:
        """Prepare for a trial; a real DAQ checks that it can run one."""

    def watchdog(self, substeps: int) -> None:
        """Zero the D/A by itself if it is not written for this long."""

    def begin(self) -> None:
        """Take the declared initial state at the trial's first tick; a real DAQ moves nothing."""

    def read(self) -> Reading:
        """Counters and A/D now."""

    def write(self, codes: LinkCounts) -> None:
        """Codes to the D/A now."""

    def readback(self) -> LinkCounts | None:
        """Codes that drive the valves now, read at the D/A's output; None where that cannot be read."""

    def inject(self, fault: Fault) -> None:
        """Break from the next sample on, `at_s` later; only what it does not refuse is asked."""

    def clear(self) -> None:
        """End what was injected."""

    def faults(self) -> tuple[Faults, Faults]:
        """Acting at the sample last read, and injected but not begun."""

    def ground_truth(self) -> GroundTruth | None:
        """What only an emulator knows."""
