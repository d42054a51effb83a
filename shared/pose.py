"""Encoder counts to joint positions, and joint positions to the tip: what controller and supervisor both need."""

import math

from shared.converters import Calibration
from shared.kernel import kernel

A2_M = 0.13  # offset of the boom from the shoulder axis (Appendix F)
A4_M = 0.5  # wrist to tool tip
D3_OFFSET_M = 0.788  # shoulder axis to wrist, boom retracted


@kernel
def joint_positions(counts: tuple[int, ...], calibration: Calibration) -> tuple[float, float, float, float]:
    """(q1, q2, q3, q4) from counters (rotate, down/up, out/in, roll, pitch): rad, rad, m, rad."""
    scale, offset = calibration.scale, calibration.offset
    return (
        scale[0] * counts[0] + offset[0],
        scale[1] * counts[1] + offset[1],
        scale[2] * counts[2] + offset[2],
        scale[3] * counts[4] + offset[3],
    )


@kernel
def wrist(q4_rad: float) -> tuple[float, float]:
    """(a2', d3' - q3) in m: the tool's offsets across and along the boom."""
    return A2_M - A4_M * math.cos(q4_rad), D3_OFFSET_M - A4_M * math.sin(q4_rad)


@kernel
def tip(q: tuple[float, float, float, float]) -> tuple[float, float, float]:
    """Tool tip (x, y, z) in m, z up from the shoulder; NaN where an angle is not finite.

    r = d3' c2 + a2' s2,  z = -d3' s2 + a2' c2,  x = r c1,  y = r s1, with q2 positive down (Appendix F, `qtox`).
    """
    for angle in q:
        if not abs(angle) < math.inf:
            return math.nan, math.nan, math.nan
    across, along = wrist(q[3])
    reach = q[2] + along
    sine, cosine = math.sin(q[1]), math.cos(q[1])
    radius = reach * cosine + across * sine
    return radius * math.cos(q[0]), radius * math.sin(q[0]), across * cosine - reach * sine
