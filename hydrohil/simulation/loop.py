"""The local clock: the step functions of plant, controller, supervisor and gate in one compiled loop."""

from typing import Any, NamedTuple

from hydrohil.services.controller.params import ControllerParams
from hydrohil.services.controller.step import ControlMemory, control_step
from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.faults import Held, Readings
from hydrohil.services.plant.faulty_actuators import faulty_codes, faulty_machine
from hydrohil.services.plant.faulty_sensors import faulty_sense
from hydrohil.services.plant.gate import CommandObservation, GateInput, GateMemory, PermitObservation, gate_step
from hydrohil.services.plant.machine import MachineState, advance, ground_truth
from hydrohil.services.plant.params import ContactParams, MachineParams
from hydrohil.services.supervisor.modes import NOTHING, RUNNING
from hydrohil.services.supervisor.observe import LinkHealth
from hydrohil.services.supervisor.state import SupervisorInput, SupervisorMemory, SupervisorParams
from hydrohil.services.supervisor.step import supervisor_step
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import LinkCounts, Permit, Sample
from hydrohil.shared.units import SUBSTEP_NS
from hydrohil.simulation.columns import Columns, Integers, Reals, write_answers, write_plant


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
    """The state that is carried from one sample to the next."""

    row: int  # the next to be written
    time_ns: int
    trial_time_ns: int
    machine: MachineState
    control: ControlMemory
    watch: SupervisorMemory
    gate: GateMemory
    ready: bool  # what the controller said last
    held: Held
    at_valves: LinkCounts


_ARMING_ID = 1  # any number but 0, because the local cell arms once
_EPOCH = 1
_LINKS = LinkHealth(faults=0, epoch_conflicts=0, other_run=0, state_lag=1)  # no link exists that could fail


@kernel
def sample_of(setup: Setup, gate: GateMemory, readings: Readings, row: int, time_ns: int, trial_time_ns: int) -> Sample:
    """The sample that the plant publishes at `row`."""
    return Sample(
        number=row,
        time_ns=time_ns,
        tick=setup.first_tick + row,
        trial_time_ns=trial_time_ns,
        encoder_counts=readings[0],
        force_counts=readings[1],
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
def gate_input(setup: Setup, sample: Sample, codes: LinkCounts, permit: Permit, arming_id: int) -> GateInput:
    """What the gate judges at the latch: every answer has come, none is late."""
    age_ns = setup.latch_substeps * SUBSTEP_NS
    return GateInput(
        permit=PermitObservation(
            present=True,
            arming_id=arming_id,
            epoch=_EPOCH,
            mode=permit.mode,
            age_ns=age_ns,
            recover_signs=permit.recover_signs,
        ),
        command=CommandObservation(
            present=True, arming_id=_ARMING_ID, epoch=_EPOCH, age_ns=age_ns, number=sample.number, codes=codes
        ),
        force_counts=sample.force_counts,
        force_n=sample.force_counts * setup.control.calibration.force_n_per_count,
        tick=sample.tick,
        estop=False,
        overrun=False,
        link_faults=0,
        epoch_conflicts=0,
    )


@kernel
def asked_at(ready: bool) -> SupervisorInput:
    """What the supervisor is given beside the sample: no request, and no link that could fail."""
    return SupervisorInput(event=NOTHING, new_arming_id=0, agreed=True, controller_ready=ready, stale_ns=0, links=_LINKS)


def begin(setup: Setup, memory: ControlMemory, intervals: Integers) -> Underway:
    """Before the first row: the cell is armed, its gate shut."""
    gate = GateMemory()
    return Underway(
        row=0,
        time_ns=0,
        trial_time_ns=-SUBSTEP_NS * int(sum(intervals[: -setup.first_tick])),
        machine=setup.start,
        control=memory,
        watch=SupervisorMemory(mode=RUNNING, arming_id=_ARMING_ID, first_sample=0),
        gate=gate,
        ready=False,
        held=Held(),
        at_valves=gate.codes,
    )


def play(
    setup: Setup, underway: Underway, table: Any, faults: Any, noise_n: Reals, intervals: Integers, out: Columns, end: int
) -> Underway:
    """Go on to row `end`, or to the row at which the supervisor leaves its mode.

    `table` holds the reference's segments and `faults` what breaks, a row each; `noise_n` and `intervals` (sub-steps) have a
    value for each row of `out`.
    """
    row, time_ns, trial_time_ns = underway.row, underway.time_ns, underway.trial_time_ns
    state, memory, watch, gate = underway.machine, underway.control, underway.watch, underway.gate
    ready, held, at_valves = underway.ready, underway.held, underway.at_valves
    while row < end and watch.mode == RUNNING:
        tick = setup.first_tick + row
        machine = faulty_machine(faults, tick, setup.machine)
        # the plant samples
        readings = faulty_sense(
            state=state,
            machine=setup.machine,
            contact=setup.contact,
            noise_n=noise_n[row],
            table=faults,
            tick=tick,
            held=held,
        )
        held = Held(readings, 1)
        sample = sample_of(setup, gate, readings, row, time_ns, trial_time_ns)
        write_plant(out, row, sample, ground_truth(state, setup.machine, setup.contact, row, tick))
        # controller and supervisor answer the sample
        memory, codes, answer = control_step(memory, setup.control, table, sample)
        watch, permit = supervisor_step(watch, setup.supervise, sample, asked_at(ready))
        ready = answer.ready == 1
        write_answers(out, row, codes, answer, permit)
        # up to the latch the valves keep their codes; there the gate judges the command
        state = advance(state, machine, setup.contact, at_valves, setup.latch_substeps)
        gate = gate_step(gate, setup.limits, gate_input(setup, sample, codes, permit, watch.arming_id), True)
        at_valves = faulty_codes(faults, tick, gate.codes, at_valves)
        state = advance(state, machine, setup.contact, at_valves, intervals[row] - setup.latch_substeps)
        time_ns += intervals[row] * SUBSTEP_NS
        trial_time_ns += intervals[row] * SUBSTEP_NS
        row += 1
    return Underway(
        row=row,
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
