"""Inverse kinematics of the Unimate with its wrist, inside the travel of every link (thesis Appendix A; `xtoq` of Appendix F).

Appendix A prints z and theta_2 with wrong signs; these are the program's, which invert `hydrohil.shared.contract.pose.forward`.
"""

import math

from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.pose import bounded_angle, wrist
from hydrohil.shared.machine.description import Geometry, Triple

CLAMPED_LOW = (1, 4, 16)  # bits of the mask: link 1, 2, 3 at its lower limit
CLAMPED_HIGH = (2, 8, 32)
CLAMPED_UNREACHABLE = 64  # nearer to the shoulder than the hand's offset: no link 3 reaches it


@kernel
def clamp_link(value: float, low: float, high: float, low_bit: int, high_bit: int) -> tuple[float, int]:
    """`value` inside [low, high] and the bit of the limit that held it; NaN stays NaN."""
    if value < low:
        return low, low_bit
    if value > high:
        return high, high_bit
    return value, 0


@kernel
def clamp_joints(geometry: Geometry, q: Triple) -> tuple[Triple, int]:
    """Joint positions inside the travel of every link, and the bit mask of what was clamped."""
    low, high = geometry.low_q, geometry.high_q
    q1, bit_1 = clamp_link(q[0], low[0], high[0], CLAMPED_LOW[0], CLAMPED_HIGH[0])
    q2, bit_2 = clamp_link(q[1], low[1], high[1], CLAMPED_LOW[1], CLAMPED_HIGH[1])
    q3, bit_3 = clamp_link(q[2], low[2], high[2], CLAMPED_LOW[2], CLAMPED_HIGH[2])
    return (q1, q2, q3), bit_1 | bit_2 | bit_3


@kernel
def inverse(geometry: Geometry, x_m: Triple, pitch_rad: float) -> tuple[Triple, int]:
    """Joint positions that put the tip at `x_m`, clamped to the links' travel, and the mask of what was clamped.

    d = sqrt(r^2 + z^2 - a^2),  q2 = atan2(a r - d z, d r + a z),  q1 = atan2(y, x)   (`xtoq`).
    `xtoq` clamps r and z to a box that is only "roughly" the envelope: its outer side, d_max cos(27 deg), cuts off
    11 % of the reach at q2 = 0 and its z sides leave out a2. Here the joints are clamped, which is the envelope itself.
    """
    along_m, a = wrist(geometry, pitch_rad)
    x, y, z = x_m
    r_square = x * x + y * y
    d_square = r_square + z * z - a * a
    unreachable = 0
    if d_square < 0.0:  # NaN passes, and stays
        d_square = 0.0
        unreachable = CLAMPED_UNREACHABLE
    r, d = math.sqrt(r_square), math.sqrt(d_square)
    q, clamped = clamp_joints(geometry, (math.atan2(y, x), math.atan2(a * r - d * z, d * r + a * z), d - along_m))
    return q, clamped | unreachable


@kernel
def tip_velocity(geometry: Geometry, q: Triple, pitch_rad: float, qd: Triple) -> Triple:
    """Velocity of the tip in m/s at joint velocities `qd`: x' = J(q) q'.

    r' = z q2' + cos(q2) q3',  z' = -r q2' - sin(q2) q3'; then turned by q1.
    """
    along_m, a = wrist(geometry, pitch_rad)
    d = q[2] + along_m
    q1, q2 = bounded_angle(q[0]), bounded_angle(q[1])
    s1, c1, s2, c2 = math.sin(q1), math.cos(q1), math.sin(q2), math.cos(q2)
    r, z = d * c2 + a * s2, -d * s2 + a * c2
    rd = z * qd[1] + c2 * qd[2]
    return (rd * c1 - r * s1 * qd[0], rd * s1 + r * c1 * qd[0], -r * qd[1] - s2 * qd[2])


@kernel
def along_axis(x: Triple, axis: int, way_m: float) -> Triple:
    """`x` moved by `way_m` along one axis."""
    return (
        x[0] + way_m if axis == 0 else x[0],
        x[1] + way_m if axis == 1 else x[1],
        x[2] + way_m if axis == 2 else x[2],
    )


@kernel
def joint_loads(geometry: Geometry, q: Triple, pitch_rad: float, force_axis: int, push_n: float) -> Triple:
    """Loads J^T f in N m (link 3: N) of a push along x (axis 0) or z (axis 2) on the tip, positive as q  (thesis 9.2.2).

    J = d forward / dq:  dr/dq2 = z, dz/dq2 = -r, dr/dq3 = cos(q2), dz/dq3 = -sin(q2); then turned by q1.
    """
    along_m, a = wrist(geometry, pitch_rad)
    d = q[2] + along_m
    q1, q2 = bounded_angle(q[0]), bounded_angle(q[1])
    s2, c2 = math.sin(q2), math.cos(q2)
    r, z = d * c2 + a * s2, -d * s2 + a * c2
    if force_axis == 2:
        return (0.0, -r * push_n, -s2 * push_n)
    outward_n = math.cos(q1) * push_n
    return (-r * math.sin(q1) * push_n, z * outward_n, c2 * outward_n)
