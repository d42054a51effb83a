"""The arm: where its tip is, what its links weigh and how they load each other.

x forward, z up; q1 turns, q2 is positive DOWN, q3 positive OUT.
"""

import math
from typing import NamedTuple

from hydrohil.services.plant.params import MachineParams
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.units import GRAVITY_M_PER_S2

Triple = tuple[float, float, float]


class Posture(NamedTuple):
    """The sines and lengths that position, inertia and loads share."""

    cos_1: float
    sin_1: float
    cos_2: float
    sin_2: float
    reach_m: float  # r, horizontal distance of the tip from the axis of link 1
    height_m: float  # z of the tip
    boom_m: float  # rho, distance of the boom's centre of mass from the axis of link 2


@kernel
def posture(machine: MachineParams, q: Triple) -> Posture:
    """d3' = q3 + d - a4 sin q4, a2' = a2 - a4 cos q4;  r = d3' c2 + a2' s2, z = -d3' s2 + a2' c2  (Appendix F, qtox)."""
    turned = math.cos(q[0]), math.sin(q[0]), math.cos(q[1]), math.sin(q[1])
    return _posed(machine, turned, q[2])


@kernel
def posture_after(arm: Posture, machine: MachineParams, before_q: Triple, q: Triple) -> Posture:
    """`posture` at `q`, given that at `before_q`: a link that stands exactly keeps its sines."""
    c1, s1, c2, s2 = arm.cos_1, arm.sin_1, arm.cos_2, arm.sin_2
    if q[0] != before_q[0]:
        c1, s1 = math.cos(q[0]), math.sin(q[0])
    if q[1] != before_q[1]:
        c2, s2 = math.cos(q[1]), math.sin(q[1])
    return _posed(machine, (c1, s1, c2, s2), q[2])


@kernel
def _posed(machine: MachineParams, turned: tuple[float, float, float, float], q3_m: float) -> Posture:
    c1, s1, c2, s2 = turned
    d3_m = q3_m + machine.d3_offset_m - machine.a4_m * math.sin(machine.q4_rad)
    a2_m = machine.a2_m - machine.a4_m * math.cos(machine.q4_rad)
    return Posture(
        cos_1=c1,
        sin_1=s1,
        cos_2=c2,
        sin_2=s2,
        reach_m=d3_m * c2 + a2_m * s2,
        height_m=-d3_m * s2 + a2_m * c2,
        boom_m=d3_m - machine.boom_centre_m,
    )


@kernel
def tip(arm: Posture) -> Triple:
    """Tip of the tool in m:  x = r cos q1, y = r sin q1, z."""
    return arm.reach_m * arm.cos_1, arm.reach_m * arm.sin_1, arm.height_m


@kernel
def inertias(machine: MachineParams, arm: Posture) -> Triple:
    """Inertia that each link moves:  J2 = J20 + m rho^2,  J1 = J10 + J2 c2^2,  m."""
    down_up = machine.inertia_down_up_kg_m2 + machine.boom_mass_kg * arm.boom_m * arm.boom_m
    return machine.inertia_rotate_kg_m2 + down_up * arm.cos_2 * arm.cos_2, down_up, machine.boom_mass_kg


@kernel
def gravity_loads(machine: MachineParams, arm: Posture) -> Triple:
    """Weight on each link:  0,  g (m rho - counterbalance) c2,  m g s2."""
    moment = machine.boom_mass_kg * arm.boom_m - machine.counterbalance_kg_m
    return 0.0, GRAVITY_M_PER_S2 * moment * arm.cos_2, GRAVITY_M_PER_S2 * machine.boom_mass_kg * arm.sin_2


@kernel
def motion_loads(machine: MachineParams, arm: Posture, inertia_2_kg_m2: float, qd: Triple) -> Triple:
    """Coriolis and centrifugal loads of  T = J1 q1'^2 / 2 + J2 q2'^2 / 2 + m q3'^2 / 2  (Lagrange)."""
    lever = machine.boom_mass_kg * arm.boom_m  # m rho = dJ2/dq3 / 2
    turn = inertia_2_kg_m2 * arm.cos_2 * arm.sin_2  # -dJ1/dq2 / 2
    c2c2 = arm.cos_2 * arm.cos_2
    return (
        2.0 * (turn * qd[1] - lever * c2c2 * qd[2]) * qd[0],
        -turn * qd[0] * qd[0] - 2.0 * lever * qd[2] * qd[1],
        lever * (qd[1] * qd[1] + c2c2 * qd[0] * qd[0]),
    )


@kernel
def tip_loads(arm: Posture, x_n: float, z_n: float) -> Triple:
    """Loads J^T f of a force on the tip:  dr/dq2 = z, dz/dq2 = -r, dr/dq3 = c2, dz/dq3 = -s2."""
    along = x_n * arm.cos_1
    return (
        -x_n * arm.reach_m * arm.sin_1,
        along * arm.height_m - z_n * arm.reach_m,
        along * arm.cos_2 - z_n * arm.sin_2,
    )
