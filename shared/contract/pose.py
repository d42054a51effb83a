"""Encoder counts to joint positions, and joint positions to the tip: what controller and supervisor both need.

q = (rotate, down/up with + down, out/in); x = (forward, left, up) from the shoulder, in m. The pitch encoder turns the hand:
0 hangs down, -90 deg points outward. With  d = q3 + retracted - a4 sin(pitch)  and  a = a2 - a4 cos(pitch):
    r = d cos q2 + a sin q2,   z = -d sin q2 + a cos q2,   x = r cos q1,   y = r sin q1   (Appendix F, `qtox`).
"""

import math

from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.converters import Calibration
from hydrohil.shared.contract.messages import Counts
from hydrohil.shared.machine.description import Geometry, Triple

LARGEST_ANGLE_RAD = 1e9  # beyond, an angle is nonsense; sin(inf) would raise


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
