"""Target impedance  m x'' + c (x' - xd') + k (x - xd) = sign (f - fd): its exact response to steps (thesis 5.1.3).

Inputs are held over each sampling interval, so every sample adds a step; force and position responses are summed.
A step dx_d of the nominal position kicks the velocity by c/m dx_d = 2 xi wn dx_d (the thesis prints the wrong sign).
"""

import math
from typing import NamedTuple

from hydrohil.services.controller.params import ImpedanceParams
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.machine.description import Triple

CRITICAL = 1e-8  # wd dt below which damping is critical: the three solutions then agree to one part in 1e16


class Decay(NamedTuple):
    """Free response over one interval:  x = c a + s b,  c = e^(-sigma t) cosh(w t),  s = e^(-sigma t) sinh(w t) / w."""

    c: float
    s: float
    sigma: float  # xi wn
    square: float  # w^2 = wn^2 (xi^2 - 1), negative when underdamped


class ImpedanceState(NamedTuple):
    """Position response of each axis and force response of the gauge's axis."""

    position_m: Triple
    velocity_m_per_s: Triple
    nominal_m: Triple  # x_d of the last sample
    force_offset_m: float
    force_velocity_m_per_s: float
    stiffness_loss: float  # what an adaptation has given way: share of the stiffness, or m


@kernel
def rest(x_m: Triple, nominal_m: Triple) -> ImpedanceState:
    """The target model standing at `x_m` while the nominal position is `nominal_m`."""
    return ImpedanceState(x_m, (0.0, 0.0, 0.0), nominal_m, 0.0, 0.0, 0.0)


@kernel
def decay(natural_frequency_rad_per_s: float, damping_ratio: float, dt_s: float) -> Decay:
    """Free response over `dt_s`, exact for every damping; NaN outside wn > 0, xi >= 0, dt >= 0.

    Overdamped: with the two real poles -(sigma - w), -(sigma + w), and expm1 in place of e^x - e^-x, nothing cancels
    near xi = 1 and nothing overflows after a long gap.
    """
    wn, xi, t = natural_frequency_rad_per_s, damping_ratio, dt_s
    sigma = xi * wn
    square = wn * wn * (xi - 1.0) * (xi + 1.0)
    w = math.sqrt(abs(square))
    if not (wn > 0.0 and xi >= 0.0 and t >= 0.0 and (sigma + w) * t < math.inf):
        return Decay(math.nan, math.nan, sigma, square)
    if w * t < CRITICAL:
        e = math.exp(-sigma * t)
        return Decay(e, e * t, sigma, square)
    if square < 0.0:
        e = math.exp(-sigma * t)
        return Decay(e * math.cos(w * t), e * math.sin(w * t) / w, sigma, square)
    slow = math.exp(-(wn * wn / (sigma + w)) * t)  # sigma - w without cancellation
    fade = math.expm1(-2.0 * w * t)
    return Decay(slow * (1.0 + 0.5 * fade), -slow * fade / (2.0 * w), sigma, square)


@kernel
def respond(free: Decay, x: float, v: float, x_end: float) -> tuple[float, float]:
    """Position and velocity after the interval of a model that starts at `x`, `v` and tends to `x_end`."""
    a = x - x_end
    b = v + free.sigma * a
    offset = free.c * a + free.s * b
    return x_end + offset, -free.sigma * offset + free.square * free.s * a + free.c * b


@kernel
def mean_of_three(newest: float, last: float, before_last: float) -> float:
    """Mean of the last three samples, the program's filter on the gauge."""
    return (newest + last + before_last) / 3.0


@kernel
def impedance_step(
    state: ImpedanceState, params: ImpedanceParams, nominal_m: Triple, force_error_n: float, dt_s: float
) -> tuple[ImpedanceState, Triple]:
    """The model after `dt_s` under x_d = `nominal_m` and f - gain f_d = `force_error_n`; and the set-point x_s.

    The environment's push on the tool is positive, so that a positive f_d presses against it.
    """
    free = decay(params.natural_frequency_rad_per_s, params.damping_ratio, dt_s)
    kick = 2.0 * free.sigma  # per m of step, c/m
    position, velocity, last = state.position_m, state.velocity_m_per_s, state.nominal_m
    x1, v1 = respond(free, position[0], velocity[0] + kick * (nominal_m[0] - last[0]), nominal_m[0])
    x2, v2 = respond(free, position[1], velocity[1] + kick * (nominal_m[1] - last[1]), nominal_m[1])
    x3, v3 = respond(free, position[2], velocity[2] + kick * (nominal_m[2] - last[2]), nominal_m[2])
    force_end_m = params.force_sign * force_error_n / params.stiffness_n_per_m
    offset, offset_rate = respond(free, state.force_offset_m, state.force_velocity_m_per_s, force_end_m)
    state = ImpedanceState((x1, x2, x3), (v1, v2, v3), nominal_m, offset, offset_rate, state.stiffness_loss)
    x_set = (
        x1 + offset if params.force_axis == 0 else x1,
        x2 + offset if params.force_axis == 1 else x2,
        x3 + offset if params.force_axis == 2 else x3,
    )
    return state, x_set
