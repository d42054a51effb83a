"""The local clock: plant, controller, supervisor and gate in one compiled loop, by the services' own step functions."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from hydrohil.services.controller.params import ControllerParams
from hydrohil.services.controller.step import ControlMemory, control_step
from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.faults import Held
from hydrohil.services.plant.faulty_actuators import faulty_codes, faulty_machine
from hydrohil.services.plant.faulty_sensors import faulty_sense
from hydrohil.services.plant.gate import CommandObservation, GateInput, GateMemory, PermitObservation, gate_step
from hydrohil.services.plant.machine import MachineState, advance, ground_truth
from hydrohil.services.plant.params import ContactParams, MachineParams
from hydrohil.services.supervisor.modes import NOTHING, RUNNING
from hydrohil.services.supervisor.observe import Links, watch_start
from hydrohil.services.supervisor.step import Asked, SupervisorMemory, SupervisorParams, supervisor_step
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import ControllerState, GroundTruth, LinkCounts, Permit, Sample
from hydrohil.shared.units import SUBSTEP_NS

Reals = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]


class Columns(NamedTuple):
    """Rows that a trial leaves, one a sample; the columns of a trace and what only an emulator knows."""

    tick: Integers
    time_ns: Integers  # since tick 0
    q: Reals
    q_set: Reals
    qd: Reals
    qd_set: Reals
    x_m: Reals
    x_set_m: Reals
    x_nominal_m: Reals
    force_n: Reals
    force_set_n: Reals
    current_a: Reals
    mode: Integers
    encoder_counts: Integers
    force_counts: Integers
    dac_counts: Integers
    clamped: Integers
    boosted: Integers
    pressure_a_pa: Reals
    pressure_b_pa: Reals
    true_q: Reals
    contact_force_n: Reals


class Setup(NamedTuple):
    """Everything a trial needs, ready for the kernel."""

    machine: MachineParams
    contact: ContactParams
    limits: GateLimits
    control: ControllerParams
    supervise: SupervisorParams
    start: MachineState
    first_tick: int
    latch_substeps: int


class Underway(NamedTuple):
    """Everything that goes on from one sample to the next."""

    row: int  # the next to be written
    time_ns: int
    trial_time_ns: int
    machine: MachineState
    control: ControlMemory
    watch: SupervisorMemory
    gate: GateMemory
    ready: bool
    held: Held
    at_valves: LinkCounts


_LINKS = ("q", "q_set", "qd", "qd_set", "x_m", "x_set_m", "x_nominal_m", "current_a")
_LINKS_TOO = ("dac_counts", "boosted", "pressure_a_pa", "pressure_b_pa", "true_q")
_WIDTHS = {"encoder_counts": (5,)} | dict.fromkeys((*_LINKS, *_LINKS_TOO), (3,))
_ARMING_ID = 1  # any number but 0: the local cell arms once
_EPOCH = 1


def columns(count: int) -> Columns:
    """Empty rows."""

    def reals(*width: int) -> Any:
        return np.zeros((count, *width))

    def integers(*width: int) -> Any:
        return np.zeros((count, *width), dtype=np.int64)

    def column(name: str, kind: object) -> Any:
        width = _WIDTHS.get(name, ())
        return integers(*width) if kind is Integers else reals(*width)

    return Columns(*(column(name, kind) for name, kind in Columns.__annotations__.items()))


@kernel
def sample_of(
    setup: Setup, gate: GateMemory, counts: tuple[tuple[int, int, int, int, int], int], i: int, time_ns: int, trial_time_ns: int
) -> Sample:
    """The sample that the plant publishes at row `i`."""
    return Sample(
        number=i,
        time_ns=time_ns,
        tick=setup.first_tick + i,
        trial_time_ns=trial_time_ns,
        encoder_counts=counts[0],
        force_counts=counts[1],
        dac_counts=gate.codes,
        gate=gate.state,
        gate_cause=gate.cause,
        gate_open_samples=gate.open_samples,
        recover_signs=gate.recover_signs,
        command_number=gate.command_number,
        command_late_substeps=0,
        command_age_ns=setup.latch_substeps * SUBSTEP_NS,
    )


@kernel
def gate_input(
    setup: Setup, permit: Permit, arming_id: int, sample: Sample, codes: tuple[int, int, int], force_n: float
) -> GateInput:
    """What the gate judges at the latch when nothing is late."""
    age_ns = setup.latch_substeps * SUBSTEP_NS
    return GateInput(
        permit=PermitObservation(True, arming_id, _EPOCH, permit.mode, age_ns, permit.recover_signs),
        command=CommandObservation(True, _ARMING_ID, _EPOCH, age_ns, sample.number, codes),
        force_counts=sample.force_counts,
        force_n=force_n,
        tick=sample.tick,
        estop=False,
        overrun=False,
        link_faults=0,  # no link, no faults of one
        epoch_conflicts=0,
    )


@kernel
def write_row(
    out: Columns, i: int, sample: Sample, codes: tuple[int, int, int], thought: ControllerState, permit: Permit, seen: GroundTruth
) -> None:
    """Row `i`: the state at the sample and the command that answers it."""
    out.tick[i] = sample.tick
    out.time_ns[i] = sample.trial_time_ns
    out.force_n[i] = thought.force_n
    out.force_set_n[i] = thought.force_set_n
    out.mode[i] = permit.mode
    out.force_counts[i] = sample.force_counts
    out.clamped[i] = thought.clamped
    out.contact_force_n[i] = seen.contact_force_n
    for k in range(3):
        out.q[i, k] = thought.q[k]
        out.q_set[i, k] = thought.q_set[k]
        out.qd[i, k] = thought.qd[k]
        out.qd_set[i, k] = thought.qd_set[k]
        out.x_m[i, k] = thought.x_m[k]
        out.x_set_m[i, k] = thought.x_set_m[k]
        out.x_nominal_m[i, k] = thought.x_nominal_m[k]
        out.current_a[i, k] = thought.current_a[k]
        out.dac_counts[i, k] = codes[k]
        out.boosted[i, k] = thought.boosted[k]
        out.pressure_a_pa[i, k] = seen.pressure_a_pa[k]
        out.pressure_b_pa[i, k] = seen.pressure_b_pa[k]
        out.true_q[i, k] = seen.q[k]
    for k in range(5):
        out.encoder_counts[i, k] = sample.encoder_counts[k]


def begin(setup: Setup, memory: ControlMemory, intervals: Integers) -> Underway:
    """Before the first row: the cell is armed, its gate shut."""
    gate = GateMemory(
        state=0,
        cause=1,
        codes=(2048, 2048, 2048),
        command_number=-1,
        open_samples=0,
        arming_id=0,
        permit_epoch=0,
        command_epoch=0,
        revoked=(0,) * 16,
        recover_signs=(0, 0, 0),
    )
    watch = SupervisorMemory(
        mode=RUNNING,
        arming_id=_ARMING_ID,
        cause=0,
        measured=0.0,
        limit=0.0,
        trip_number=-1,
        first_sample=0,
        armed_at=0,
        held_until=0,
        recover_signs=(0, 0, 0),
        watch=watch_start(),
        pressed=False,
    )
    trial_time_ns = -SUBSTEP_NS * int(sum(intervals[: -setup.first_tick]))
    held = Held(((0, 0, 0, 0, 0), 0), 0)
    return Underway(
        row=0,
        time_ns=0,
        trial_time_ns=trial_time_ns,
        machine=setup.start,
        control=memory,
        watch=watch,
        gate=gate,
        ready=False,
        held=held,
        at_valves=gate.codes,
    )


def play(
    setup: Setup, underway: Underway, table: Any, faults: Any, noise_n: Reals, intervals: Integers, out: Columns, end: int
) -> Underway:
    """Go on to row `end`, or to the row at which the supervisor leaves its mode."""
    first, time_ns, trial_time_ns, state, memory, watch, gate, ready, held, at_valves = underway
    for i in range(first, end):
        tick = setup.first_tick + i
        counts = faulty_sense(
            state=state, machine=setup.machine, contact=setup.contact, noise_n=noise_n[i], table=faults, tick=tick, held=held
        )
        held, machine = Held(counts, 1), faulty_machine(faults, tick, setup.machine)
        sample = sample_of(setup, gate, counts, i, time_ns, trial_time_ns)
        seen = ground_truth(state, setup.machine, setup.contact, i, sample.tick)
        memory, codes, thought = control_step(memory, setup.control, table, sample)
        watch, permit = supervisor_step(watch, setup.supervise, sample, Asked(NOTHING, 0, True, ready, 0, Links(0, 0, 0, 1)))
        ready = thought.ready == 1
        write_row(out=out, i=i, sample=sample, codes=codes, thought=thought, permit=permit, seen=seen)
        state = advance(state, machine, setup.contact, at_valves, setup.latch_substeps)
        force_n = sample.force_counts * setup.control.calibration.force_n_per_count
        gate = gate_step(gate, setup.limits, gate_input(setup, permit, watch.arming_id, sample, codes, force_n), True)
        at_valves = faulty_codes(faults, tick, gate.codes, at_valves)
        state = advance(state, machine, setup.contact, at_valves, intervals[i] - setup.latch_substeps)
        time_ns += intervals[i] * SUBSTEP_NS
        trial_time_ns += intervals[i] * SUBSTEP_NS
        if watch.mode != RUNNING:
            return Underway(
                row=i + 1,
                time_ns=time_ns,
                trial_time_ns=trial_time_ns,
                machine=state,
                control=memory,
                watch=watch,
                gate=gate,
                ready=ready,
                held=held,
                at_valves=at_valves,
            )
    return Underway(
        row=end,
        time_ns=time_ns,
        trial_time_ns=trial_time_ns,
        machine=state,
        control=memory,
        watch=watch,
        gate=gate,
        ready=ready,
        held=held,
        at_valves=at_valves,
    )
