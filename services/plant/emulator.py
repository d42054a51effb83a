"""The emulated machine behind the DAQ's two functions; its time is what the shell's timeline says."""

from typing import Any

from services.plant.config import PlantConfig
from services.plant.device import Reading, Timeline
from services.plant.machine import MachineState, advance, machine_start, sense, truth
from services.plant.noise import force_noise_n
from services.plant.params import contact_params
from shared.converters import ZERO_CODE
from shared.kernel import compiled
from shared.messages import NO_TRIAL, LinkCounts, Truth

_IDLE_NOISE_TICKS = 4096  # outside a trial the noise repeats after this many samples
_ZERO: LinkCounts = (ZERO_CODE, ZERO_CODE, ZERO_CODE)


class Emulator:
    """Plays the machine up to the timeline's sub-step whenever it is read or written.

    Only the sub-steps are compiled: reading once a sample costs less plain than a call into compiled code.
    Its D/A has the output watchdog that a DAQ needs: not written for `watchdog_substeps`, it goes to zero by itself.
    """

    def __init__(self, timeline: Timeline, watchdog_substeps: int) -> None:
        """Compile the machine and stand at the default pose."""
        self._timeline, self._watchdog = timeline, watchdog_substeps
        self._advance: Any = compiled(advance)
        self._at = self._written_at = 0
        self._codes = _ZERO
        self.load(PlantConfig(), 0, 0, _IDLE_NOISE_TICKS)
        self.begin()
        self._advance(self._state, self._machine, self._contact, _ZERO, 1)

    def watchdog(self, substeps: int) -> None:
        """Another lease was chosen."""
        self._watchdog = substeps

    def load(self, config: PlantConfig, seed: int, first_tick: int, ticks: int) -> None:
        """Prepare the noise and the initial state of a trial of `ticks` samples from `first_tick` on."""
        machine = config.machine
        contact = contact_params(config.environment)
        start = machine_start(machine, contact, config.initial_q_rad)
        noise = force_noise_n(seed, first_tick, ticks, machine.force_noise_sigma_n, machine.force_noise_clip_n)
        self._next = (machine, contact, start)
        self._first_tick, self._noise_n = first_tick, [float(value) for value in noise]

    def begin(self) -> None:
        """Stand at the declared initial state."""
        self._machine, self._contact, start = self._next
        self._state: MachineState = start
        self._codes = _ZERO
        self._at = self._written_at = self._timeline.substep

    def read(self) -> Reading:
        """Counters and A/D counts at the timeline's sub-step."""
        self._play()
        timeline = self._timeline
        index = timeline.tick - self._first_tick if timeline.tick != NO_TRIAL else timeline.number
        noise_n = self._noise_n[index % len(self._noise_n)]
        encoders, force = sense(self._state, self._machine, self._contact, noise_n)
        return Reading(encoders, force)

    def write(self, codes: LinkCounts) -> None:
        """Codes to the D/A at the timeline's sub-step."""
        self._play()
        self._codes, self._written_at = codes, self._timeline.substep

    def truth(self) -> Truth:
        """What only an emulator knows, at the sub-step last read or written."""
        timeline = self._timeline
        return truth(self._state, self._machine, self._contact, timeline.number, timeline.tick)

    def _play(self) -> None:
        """Sub-steps up to now; the watchdog falls at its own sub-step."""
        now = self._timeline.substep
        expires = max(self._written_at + self._watchdog, self._at)
        if expires < now:
            self._run_to(expires)
            self._codes = _ZERO
        self._run_to(now)

    def _run_to(self, substep: int) -> None:
        if substep > self._at:
            self._state = self._advance(self._state, self._machine, self._contact, self._codes, substep - self._at)
            self._at = substep
