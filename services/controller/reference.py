"""References: the start value of every channel plus the sum of its segments.

The closed set of segments that passes TOML, the wire and a foreign controller; here as rows of numbers for the kernels.
"""

import math

from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.pose import bounded_angle

Row = tuple[float, float, float, float, float, float, float, float, float]
Table = tuple[Row, ...]  # live; a float64 array (n, 9) in a rollout
Deltas = tuple[float, float, float, float, float, float, float]  # q1, q2, q3, x, y, z, force

CHANNELS = ("q1", "q2", "q3", "x", "y", "z", "force")
KINDS = ("step", "ramp", "sine")
COLUMNS = ("channel", "kind", "start_s", "duration_s", "amount", "blend_s", "omega_rad_per_s", "phase_rad", "amount_end")


@kernel
def ramp_share(t_s: float, duration_s: float, blend_s: float) -> float:
    """Share of a ramp done after `t_s`: parabola over `blend_s`, constant velocity, mirrored parabola."""
    if t_s >= duration_s or blend_s >= duration_s:
        return 1.0
    speed = 1.0 / (duration_s - blend_s)
    if t_s < blend_s:
        return 0.5 * speed * t_s * t_s / blend_s
    left_s = duration_s - t_s
    if left_s < blend_s:
        return 1.0 - 0.5 * speed * left_s * left_s / blend_s
    return speed * (t_s - 0.5 * blend_s)


@kernel
def sine_value(
    t_s: float, duration_s: float, amount: float, omega_rad_per_s: float, phase_rad: float, amount_end: float
) -> float:
    """a(t) (sin(w t + phase) - sin(phase)), a falling linearly to `amount_end`; held after `duration_s`."""
    t = t_s if t_s < duration_s else duration_s
    a = amount + (amount_end - amount) * (t / duration_s if duration_s > 0.0 else 1.0)
    angle, phase = bounded_angle(omega_rad_per_s * t + phase_rad), bounded_angle(phase_rad)
    return a * (math.sin(angle) - math.sin(phase))


@kernel
def reference_deltas(table: Table, time_s: float) -> Deltas:
    """What the segments add to every channel's start value at `time_s` after tick 0 (rad, m, N)."""
    q1, q2, q3, x, y, z, force = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(table)):
        row = table[i]
        channel, kind, t, duration, amount = row[0], row[1], time_s - row[2], row[3], row[4]
        if t < 0.0:
            continue
        value = amount
        if kind == 1.0:
            value = amount * ramp_share(t, duration, row[5])
        elif kind == 2.0:
            value = sine_value(t, duration, amount, row[6], row[7], row[8])
        if channel == 0.0:
            q1 += value
        elif channel == 1.0:
            q2 += value
        elif channel == 2.0:
            q3 += value
        elif channel == 3.0:
            x += value
        elif channel == 4.0:
            y += value
        elif channel == 5.0:
            z += value
        else:
            force += value
    return (q1, q2, q3, x, y, z, force)
