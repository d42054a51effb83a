"""The machine between two samples: currents into valves, flows, pressures, motion, contact; and what can be read of it."""

from typing import Any, NamedTuple

from hydrohil.services.plant.contact import ContactState, contact_start, contact_step
from hydrohil.services.plant.friction import friction_limit, slide
from hydrohil.services.plant.hydraulics import LinkState, chamber_step, port_area, port_flows, spool_step
from hydrohil.services.plant.mechanism import (
    Triple,
    gravity_loads,
    inertias,
    motion_loads,
    posture,
    posture_after,
    tip,
    tip_loads,
)
from hydrohil.services.plant.params import AXIS_X, ContactParams, LinkParams, MachineParams
from hydrohil.services.plant.sensors import encoder_counts, gauge_counts
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.converters import code_to_current
from hydrohil.shared.contract.messages import GroundTruth, LinkCounts
from hydrohil.shared.machine.description import LINKS
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.units import SUBSTEP_S

DRIVE = UNIMATE.drive


class MachineState(NamedTuple):
    """Everything that the machine remembers; a link stands exactly where its speed is 0.0."""

    q: Triple
    qd: Triple
    spool_a: Triple
    pressure_a_pa: Triple
    pressure_b_pa: Triple
    contact: ContactState


@kernel
def within(value: float, low: float, high: float) -> float:
    """`value` limited; a NaN stays a NaN."""
    if value < low:
        return low
    if value > high:
        return high
    return value


@kernel
def link_of(state: MachineState, link: LinkParams, index: int) -> LinkState:
    """One link of the machine, inside its travel."""
    return LinkState(
        within(state.q[index], link.travel_low_q, link.travel_high_q),
        state.qd[index],
        state.spool_a[index],
        state.pressure_a_pa[index],
        state.pressure_b_pa[index],
    )


@kernel
def link_step(
    state: LinkState,
    link: LinkParams,
    machine: MachineParams,
    current_a: float,
    load_tau: float,
    inertia_tau_s2_per_q: float,
    step_s: float,
) -> LinkState:
    """Valve, pressures with the old speed, speed by projection, then position (semi-implicit Euler); knows no stops."""
    ends_pa = (machine.supply_pressure_pa, machine.return_pressure_pa)
    spool_a = spool_step(link, state.spool_a, current_a, step_s)
    gain = link.flow_gain_m3_per_s_sqrt_pa * port_area(link, spool_a)
    flows = port_flows(gain, (state.pressure_a_pa, state.pressure_b_pa), ends_pa, machine.root_smoothing_pa)
    a_pa, b_pa = chamber_step(link, state, flows, ends_pa, step_s)
    pressed_tau = link.displacement_m3_per_q * (a_pa - link.area_ratio * b_pa)
    drive_tau = pressed_tau - link.viscous_tau_s_per_q * state.qd + load_tau
    limit_tau = friction_limit(link, state.qd)
    speed = slide(state.qd, inertia_tau_s2_per_q, drive_tau, limit_tau, step_s)
    return LinkState(state.q + step_s * speed, speed, spool_a, a_pa, b_pa)


@kernel
def inside(state: LinkState, link: LinkParams) -> bool:
    """Whether the link is inside its travel, ends included; a NaN is not."""
    return link.travel_low_q <= state.q <= link.travel_high_q


@kernel
def stopped(state: LinkState, link: LinkParams) -> LinkState:
    """The link inside its travel: the stop that it went beyond absorbs its speed."""
    if inside(state, link):
        return state
    q = within(state.q, link.travel_low_q, link.travel_high_q)
    return LinkState(q, 0.0, state.spool_a, state.pressure_a_pa, state.pressure_b_pa)


@kernel
def advance_by(
    state: MachineState,
    machine: MachineParams,
    contact: ContactParams,
    currents_a: Triple,
    substeps: int,
    step_s: float,
) -> MachineState:
    """The machine after `substeps` steps of `step_s` under constant valve currents."""
    first = link_of(state, machine.rotate, 0)
    second = link_of(state, machine.down_up, 1)
    third = link_of(state, machine.out_in, 2)
    touch = state.contact
    at_q = (first.q, second.q, third.q)
    arm = posture(machine, at_q)
    for _ in range(substeps):
        before_q, at_q = at_q, (first.q, second.q, third.q)
        arm = posture_after(arm, machine, before_q, at_q)
        touch = contact_step(touch, contact, machine, tip(arm), step_s)
        push_n = contact.force_sign * touch.force_n
        along_x = contact.force_axis == AXIS_X
        weight = gravity_loads(machine, arm)
        pushed = tip_loads(arm, push_n if along_x else 0.0, 0.0 if along_x else push_n)
        inertia = inertias(machine, arm)
        moved = motion_loads(machine, arm, inertia[1], (first.qd, second.qd, third.qd))
        load_1, load_2, load_3 = moved[0] + pushed[0], moved[1] + pushed[1] + weight[1], moved[2] + pushed[2] + weight[2]
        first = link_step(
            state=first,
            link=machine.rotate,
            machine=machine,
            current_a=currents_a[0],
            load_tau=load_1,
            inertia_tau_s2_per_q=inertia[0],
            step_s=step_s,
        )
        second = link_step(
            state=second,
            link=machine.down_up,
            machine=machine,
            current_a=currents_a[1],
            load_tau=load_2,
            inertia_tau_s2_per_q=inertia[1],
            step_s=step_s,
        )
        third = link_step(
            state=third,
            link=machine.out_in,
            machine=machine,
            current_a=currents_a[2],
            load_tau=load_3,
            inertia_tau_s2_per_q=inertia[2],
            step_s=step_s,
        )
        if not (inside(first, machine.rotate) and inside(second, machine.down_up) and inside(third, machine.out_in)):
            first, second, third = (
                stopped(first, machine.rotate),
                stopped(second, machine.down_up),
                stopped(third, machine.out_in),
            )
    return MachineState(
        (first.q, second.q, third.q),
        (first.qd, second.qd, third.qd),
        (first.spool_a, second.spool_a, third.spool_a),
        (first.pressure_a_pa, second.pressure_a_pa, third.pressure_a_pa),
        (first.pressure_b_pa, second.pressure_b_pa, third.pressure_b_pa),
        touch,
    )


@kernel
def advance(
    state: MachineState, machine: MachineParams, contact: ContactParams, codes: LinkCounts, substeps: int
) -> MachineState:
    """The machine `substeps` of 50 us later, the D/A holding `codes`."""
    currents_a = (code_to_current(DRIVE, codes[0]), code_to_current(DRIVE, codes[1]), code_to_current(DRIVE, codes[2]))
    return advance_by(state, machine, contact, currents_a, substeps, SUBSTEP_S)


@kernel
def advance_resident(state: MachineState, rig: Any, codes: LinkCounts, substeps: int) -> MachineState:
    """`advance` of the machine and contact that are `rig.value`."""
    machine, contact = rig.value
    return advance(state, machine, contact, codes, substeps)


@kernel
def tip_position(state: MachineState, machine: MachineParams) -> Triple:
    """Where the tip of the tool is, in m."""
    first = link_of(state, machine.rotate, 0)
    second = link_of(state, machine.down_up, 1)
    third = link_of(state, machine.out_in, 2)
    return tip(posture(machine, (first.q, second.q, third.q)))


@kernel
def contact_force(state: MachineState, machine: MachineParams, contact: ContactParams) -> float:
    """Compression of the gauge in N, never negative."""
    return state.contact.force_n


@kernel
def sense(
    state: MachineState, machine: MachineParams, contact: ContactParams, noise_n: float
) -> tuple[tuple[int, int, int, int, int], int]:
    """Encoder counters and counts of the force gauge at this instant."""
    counts = encoder_counts(state.q, machine.q4_rad)
    return counts, gauge_counts(machine, contact_force(state, machine, contact), noise_n)


@kernel
def sticking(state: MachineState) -> LinkCounts:
    """1 for each link that static friction holds."""
    speeds = state.qd
    return int(speeds[0] == 0.0), int(speeds[1] == 0.0), int(speeds[2] == 0.0)


@kernel
def ground_truth(state: MachineState, machine: MachineParams, contact: ContactParams, number: int, tick: int) -> GroundTruth:
    """What only an emulator knows, as it is published."""
    return GroundTruth(
        number=number,
        tick=tick,
        q=state.q,
        qd=state.qd,
        pressure_a_pa=state.pressure_a_pa,
        pressure_b_pa=state.pressure_b_pa,
        spool_a=state.spool_a,
        sticking=sticking(state),
        tip_m=tip_position(state, machine),
        contact_force_n=contact_force(state, machine, contact),
        environment_m=state.contact.environment_m,
    )


def balanced_pressures(machine: MachineParams, link: LinkParams, load_tau: float) -> tuple[float, float]:
    """Chamber pressures that carry `load_tau`:  D (Pa - r Pb) + tau = 0,  Pa + Pb = Ps + Pr;  r = Db / Da."""
    middle_pa = (machine.supply_pressure_pa + machine.return_pressure_pa) / 2.0
    ratio = link.area_ratio
    half_pa = (-load_tau / link.displacement_m3_per_q - middle_pa * (1.0 - ratio)) / (1.0 + ratio)
    low_pa, high_pa = machine.return_pressure_pa, machine.supply_pressure_pa
    return within(middle_pa + half_pa, low_pa, high_pa), within(middle_pa - half_pa, low_pa, high_pa)


def machine_start(machine: MachineParams, contact: ContactParams, q: Triple) -> MachineState:
    """The machine at rest at `q`: stuck, balanced, spools at null; ValueError outside the travel."""
    links = (machine.rotate, machine.down_up, machine.out_in)
    for name, unit, value, link in zip(LINKS, ("rad", "rad", "m"), q, links, strict=True):
        if not link.travel_low_q <= value <= link.travel_high_q:
            raise ValueError(f"{name} starts at {value:g} {unit}; expected {link.travel_low_q:g}..{link.travel_high_q:g} {unit}")
    arm = posture(machine, q)
    touch = contact_start(contact, machine, tip(arm))
    push_n = contact.force_sign * touch.force_n
    pushed = tip_loads(arm, push_n, 0.0) if contact.force_axis == AXIS_X else tip_loads(arm, 0.0, push_n)
    weight = gravity_loads(machine, arm)
    pressures = [balanced_pressures(machine, link, p + w) for link, p, w in zip(links, pushed, weight, strict=True)]
    a, b = zip(*pressures, strict=True)
    return MachineState(
        (q[0], q[1], q[2]),
        (0.0, 0.0, 0.0),
        (machine.rotate.null_bias_a, machine.down_up.null_bias_a, machine.out_in.null_bias_a),
        (a[0], a[1], a[2]),
        (b[0], b[1], b[2]),
        touch,
    )
