"""The emulated machine behind the DAQ's two functions; its time is what the shell's timeline says."""

from typing import Any

from hydrohil.services.plant.config import PlantConfig
from hydrohil.services.plant.device import Faults, Reading, Timeline
from hydrohil.services.plant.faults import Held, Row
from hydrohil.services.plant.faulty_actuators import faulty_codes, faulty_machine
from hydrohil.services.plant.faulty_sensors import faulty_sense
from hydrohil.services.plant.injection import Injection, clock
from hydrohil.services.plant.machine import MachineState, advance_resident, ground_truth, machine_start, sense
from hydrohil.services.plant.noise import force_noise_n
from hydrohil.services.plant.params import contact_params
from hydrohil.shared.compiled.compiled_value import compiled_value
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.faults import Fault, of_group
from hydrohil.shared.contract.messages import NO_TRIAL, GroundTruth, LinkCounts
from hydrohil.shared.units import SUBSTEP_NS

_IDLE_NOISE_TICKS = 4096  # outside a trial the noise repeats after this many samples
_ZERO: LinkCounts = (ZERO_CODE, ZERO_CODE, ZERO_CODE)


class Emulator:
    """Plays the machine up to the timeline's sub-step whenever it is read or written.

    Only the sub-steps are compiled: reading once a sample costs less plain than a call into compiled code.
    Its D/A has the output watchdog that a DAQ needs: not written for `watchdog_substeps`, it goes to zero by itself.
    Its output can be read back.
    Faults act from one reading to the next; without any it is the sound machine and nothing else.
    """

    def __init__(self, timeline: Timeline, watchdog_substeps: int) -> None:
        """Compile the machine and stand at the default pose."""
        self._timeline, self._watchdog = timeline, watchdog_substeps
        self._advance: Any = compiled(advance_resident)
        self._at = self._written_at = 0
        self._codes = _ZERO
        self._injection = Injection()
        self._table: tuple[Row, ...] = ()
        self.load(PlantConfig(), 0, 0, _IDLE_NOISE_TICKS, ())
        self.begin()
        self._advance(self._state, self._rig, _ZERO, 1)

    def watchdog(self, substeps: int) -> None:
        """Another lease was chosen."""
        self._watchdog = substeps

    def refuses(self, faults: Faults) -> str:
        """An emulator can break in every way that the table of faults knows for sensors and actuators."""
        of_machine = of_group(faults, "sensor", "actuator")
        return "" if len(of_machine) == len(faults) else "the machine breaks its sensors and actuators alone"

    def load(self, config: PlantConfig, seed: int, first_tick: int, ticks: int, faults: Faults) -> None:
        """Prepare the noise, the faults and the initial state of a trial of `ticks` samples from `first_tick` on."""
        machine = config.machine
        contact = contact_params(config.environment)
        start = machine_start(machine, contact, config.initial_q)
        noise = force_noise_n(seed, first_tick, ticks, machine.force_noise_sigma_n, machine.force_noise_clip_n)
        self._next = (machine, contact, start)
        self._injection.schedule(faults, seed, config.sample_period_substeps * SUBSTEP_NS)
        self._first_tick, self._noise_n = first_tick, [float(value) for value in noise]

    def begin(self) -> None:
        """Stand at the declared initial state."""
        self._machine, self._contact, start = self._next
        self._sound = self._rig = compiled_value((self._machine, self._contact))
        self._state: MachineState = start
        self._held = Held()
        self._codes = _ZERO
        self._at = self._written_at = self._timeline.substep

    def read(self) -> Reading:
        """Counters and A/D counts at the timeline's sub-step."""
        self._play()
        timeline = self._timeline
        index = timeline.tick - self._first_tick if timeline.tick != NO_TRIAL else timeline.number
        noise_n = self._noise_n[index % len(self._noise_n)]
        self._table, self._now = self._injection.at(timeline.number, timeline.tick), clock(timeline.number, timeline.tick)
        if self._table:
            self._rig = compiled_value((faulty_machine(self._table, self._now, self._machine), self._contact))
            readings = faulty_sense(
                state=self._state,
                machine=self._machine,
                contact=self._contact,
                noise_n=noise_n,
                table=self._table,
                tick=self._now,
                held=self._held,
            )
        else:
            self._rig = self._sound
            readings = sense(self._state, self._machine, self._contact, noise_n)
        self._held = Held(readings, 1)
        return Reading(*readings)

    def write(self, codes: LinkCounts) -> None:
        """Codes to the D/A at the timeline's sub-step."""
        self._play()
        self._codes, self._written_at = self._driven(codes), self._timeline.substep

    def readback(self) -> LinkCounts:
        """What stands at the D/A's output at the timeline's sub-step."""
        self._play()
        return self._codes

    def inject(self, fault: Fault) -> None:
        """One fault by hand; `at_s` counts from the next sample."""
        self._injection.inject(fault, self._timeline.number)

    def clear(self) -> None:
        """End what was injected by hand."""
        self._injection.clear()

    def faults(self) -> tuple[Faults, Faults]:
        """Acting at the sample last read, and injected but not begun."""
        return self._injection.acting, self._injection.waiting

    def ground_truth(self) -> GroundTruth:
        """What only an emulator knows, at the sub-step last read or written."""
        timeline = self._timeline
        return ground_truth(self._state, self._machine, self._contact, timeline.number, timeline.tick)

    def _play(self) -> None:
        """Sub-steps up to now; the watchdog falls at its own sub-step."""
        now = self._timeline.substep
        expires = max(self._written_at + self._watchdog, self._at)
        if expires < now:
            self._run_to(expires)
            self._codes = self._driven(_ZERO)
        self._run_to(now)

    def _driven(self, codes: LinkCounts) -> LinkCounts:
        """The D/A's output when it is given `codes`: one that is stuck holds what it has, against its watchdog too."""
        return faulty_codes(self._table, self._now, codes, self._codes) if self._table else codes

    def _run_to(self, substep: int) -> None:
        if substep > self._at:
            self._state = self._advance(self._state, self._rig, self._codes, substep - self._at)
            self._at = substep
