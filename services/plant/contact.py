"""The tool against its environment: the gauge's spring and damper in series with a plate, or against a crate.

The gauge is a spring and a damper side by side and has no mass; its compression is the state. It can only push: when
it lets go, it relaxes by itself, and it meets the surface again where its end then is.
"""

from typing import NamedTuple

from hydrohil.services.plant.friction import slide
from hydrohil.services.plant.mechanism import Triple
from hydrohil.services.plant.params import FREE, PLATE, ContactParams, MachineParams
from hydrohil.shared.compiled.kernel import kernel


class ContactState(NamedTuple):
    """Compression of the gauge, and what it has done to the environment."""

    gauge_m: float
    environment_m: float  # the plate's deflection, or how far the crate has gone
    environment_m_per_s: float  # of the crate
    force_n: float  # compression, never negative


@kernel
def depth(contact: ContactParams, environment_m: float, tip_m: Triple) -> float:
    """How far the unloaded tool would reach into plate or crate; negative is the gap between them."""
    if contact.kind == PLATE:
        return contact.surface_m - tip_m[2]
    return tip_m[0] - contact.surface_m - environment_m


@kernel
def relaxed(machine: MachineParams, gauge_m: float, step_s: float) -> float:
    """Compression of the gauge that nothing touches:  ks s + bs s' = 0, implicit."""
    damping = machine.sensor_damping_ns_per_m / step_s
    return gauge_m * damping / (machine.sensor_stiffness_n_per_m + damping)


@kernel
def on_plate(state: ContactState, contact: ContactParams, machine: MachineParams, depth_m: float, step_s: float) -> ContactState:
    """Gauge and plate in series:  ks s + bs s' = ke (p - s),  implicit in s."""
    damping = machine.sensor_damping_ns_per_m / step_s
    plate = contact.stiffness_n_per_m
    gauge_m = (plate * depth_m + damping * state.gauge_m) / (plate + damping + machine.sensor_stiffness_n_per_m)
    bent_m = depth_m - gauge_m
    if bent_m <= 0.0:
        return ContactState(relaxed(machine, state.gauge_m, step_s), 0.0, 0.0, 0.0)
    return ContactState(gauge_m, bent_m, 0.0, plate * bent_m)


@kernel
def on_crate(state: ContactState, contact: ContactParams, machine: MachineParams, depth_m: float, step_s: float) -> ContactState:
    """Gauge against a mass under dry friction:  f = ks p + bs p',  m v' = f - friction  (thesis 5.5)."""
    stiffness, damping = machine.sensor_stiffness_n_per_m, machine.sensor_damping_ns_per_m / step_s
    gauge_m = depth_m
    force_n = stiffness * depth_m + damping * (depth_m - state.gauge_m)
    if force_n <= 0.0:
        gauge_m = relaxed(machine, state.gauge_m, step_s)
        force_n = 0.0
    limit_n = contact.breakaway_n if state.environment_m_per_s == 0.0 else contact.sliding_n
    speed = slide(state.environment_m_per_s, contact.mass_kg, force_n, limit_n, step_s)
    return ContactState(gauge_m, state.environment_m + step_s * speed, speed, force_n)


@kernel
def contact_step(
    state: ContactState,
    contact: ContactParams,
    machine: MachineParams,
    tip_m: Triple,
    step_s: float,
) -> ContactState:
    """Contact after a step in which the tip is at `tip_m`."""
    if contact.kind == FREE:
        return ContactState(0.0, 0.0, 0.0, 0.0)
    depth_m = depth(contact, state.environment_m, tip_m)
    if contact.kind == PLATE:
        return on_plate(state, contact, machine, depth_m, step_s)
    return on_crate(state, contact, machine, depth_m, step_s)


def contact_start(contact: ContactParams, machine: MachineParams, tip_m: Triple) -> ContactState:
    """Contact at rest: springs in series carry what the tool's depth asks for."""
    depth_m = depth(contact, 0.0, tip_m)
    if contact.kind == FREE or depth_m <= 0.0:
        return ContactState(0.0, 0.0, 0.0, 0.0)
    stiffness = machine.sensor_stiffness_n_per_m
    if contact.kind != PLATE:
        return ContactState(depth_m, 0.0, 0.0, stiffness * depth_m)
    plate = contact.stiffness_n_per_m
    force_n = depth_m * plate * stiffness / (plate + stiffness)
    return ContactState(force_n / stiffness, force_n / plate, 0.0, force_n)
