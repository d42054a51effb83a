"""Forward and inverse kinematics of the Unimate with its wrist (thesis Appendix A; `qtox`, `xtoq` of Appendix F).

q = (rotate, down/up with + down, out/in); x = (forward, left, up) from the shoulder, in m. The pitch encoder turns the hand:
0 hangs down, -90 deg points outward. With  d = q3 + 0.788 - a4 sin(pitch)  and  a = a2 - a4 cos(pitch):
    r = d cos q2 + a sin q2,   z = -d sin q2 + a cos q2,   x = r cos q1,   y = r sin q1.
Appendix A prints z and theta_2 with wrong signs; these are the program's, which invert each other.
"""

import math
from typing import NamedTuple

from shared.converters import Calibration
from shared.kernel import kernel
from shared.messages import Counts
from shared.units import RAD_PER_DEG

Triple = tuple[float, float, float]

LARGEST_ANGLE_RAD = 1e9  # beyond, an angle is nonsense; sin(inf) would raise
CLAMPED_LOW = (1, 4, 16)  # bits of the mask: link 1, 2, 3 at its lower limit
CLAMPED_HIGH = (2, 8, 32)
CLAMPED_UNREACHABLE = 64  # nearer to the shoulder than the hand's offset: no link 3 reaches it


class Geometry(NamedTuple):
    """Lengths and joint travel (Appendix F, `a2`, `a4`, `HighLimit`, `LowLimit`)."""

    offset_m: float = 0.13  # a2, shoulder axis to boom
    hand_m: float = 0.5  # a4, wrist to tip
    retracted_m: float = 0.788  # boom length at q3 = 0
    low_rad: Triple = (-110 * RAD_PER_DEG, -30 * RAD_PER_DEG, 0.788 - 0.788)
    high_rad: Triple = (110 * RAD_PER_DEG, 27 * RAD_PER_DEG, 1.828 - 0.788)


UNIMATE_GEOMETRY = Geometry()


@kernel
def joint_positions(calibration: Calibration, counts: Counts) -> tuple[Triple, float]:
    """Joint positions and hand pitch that five encoder counts state; the roll encoder is used nowhere."""
    scale, offset, _ = calibration
    q = (scale[0] * counts[0] + offset[0], scale[1] * counts[1] + offset[1], scale[2] * counts[2] + offset[2])
    return q, scale[3] * counts[4] + offset[3]


@kernel
def bounded_angle(angle_rad: float) -> float:
    """The angle, or NaN where no angle can be meant, so that sin and cos never leave their domain."""
    return angle_rad if abs(angle_rad) <= LARGEST_ANGLE_RAD else math.nan


@kernel
def wrist(geometry: Geometry, pitch_rad: float) -> tuple[float, float]:
    """What the hand adds: (boom length at q3 = 0, offset across the boom), in m."""
    pitch_rad = bounded_angle(pitch_rad)
    along_m = geometry.retracted_m - geometry.hand_m * math.sin(pitch_rad)
    return along_m, geometry.offset_m - geometry.hand_m * math.cos(pitch_rad)


@kernel
def forward(geometry: Geometry, q: Triple, pitch_rad: float) -> Triple:
    """Position of the tip in m at joint positions `q`."""
    along_m, a = wrist(geometry, pitch_rad)
    d = q[2] + along_m
    q1, q2 = bounded_angle(q[0]), bounded_angle(q[1])
    s2, c2 = math.sin(q2), math.cos(q2)
    r = d * c2 + a * s2
    return (r * math.cos(q1), r * math.sin(q1), -d * s2 + a * c2)


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
    low, high = geometry.low_rad, geometry.high_rad
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
