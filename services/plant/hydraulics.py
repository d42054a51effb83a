"""Servo valve and chambers of one link: spool, parabolic ports, orifice flow, pressures."""

import math
from typing import NamedTuple

from hydrohil.services.plant.params import LinkParams
from hydrohil.shared.compiled.kernel import kernel


class LinkState(NamedTuple):
    """What one link and its actuator remember; it stands exactly where its speed is 0.0."""

    q: float
    qd: float
    spool_a: float
    pressure_a_pa: float
    pressure_b_pa: float


@kernel
def spool_step(link: LinkParams, spool_a: float, current_a: float, step_s: float) -> float:
    """Spool position as a current:  x' = (u + u_null - x) / tau."""
    return spool_a + step_s / link.valve_lag_s * (current_a + link.null_bias_a - spool_a)


@kernel
def port_area(link: LinkParams, spool_a: float) -> float:
    """Open part of the port, signed:  a(x) = sgn(x) (max(0, |x| - u0) / (full scale - u0))^2  (thesis 4.2)."""
    open_a = abs(spool_a) - link.overlap_a
    if open_a <= 0.0:
        return 0.0
    part = open_a / (link.full_scale_a - link.overlap_a)
    return part * part if spool_a > 0.0 else -(part * part)


@kernel
def signed_root(drop_pa: float, smoothing_pa: float) -> float:
    """Square root of a pressure drop with its sign, linear near zero:  phi(d) = d / (d^2 + eps^2)^(1/4)."""
    return drop_pa / math.sqrt(math.sqrt(drop_pa * drop_pa + smoothing_pa * smoothing_pa))


@kernel
def port_flows(
    gain: float, pressures_pa: tuple[float, float], ends_pa: tuple[float, float], smoothing_pa: float
) -> tuple[float, float]:
    """Flows into chambers A and B in m3/s;  gain = K_q a(x): positive feeds A from the supply and drains B.

    `ends_pa` are supply and return.

    Qa = K_q a phi(Ps - Pa), Qb = -K_q a phi(Pb - Pr); mirrored for a negative area  (orifice equation, thesis 3.2.1).
    """
    pressure_a_pa, pressure_b_pa = pressures_pa
    supply_pa, return_pa = ends_pa
    if gain > 0.0:
        return (
            gain * signed_root(supply_pa - pressure_a_pa, smoothing_pa),
            -gain * signed_root(pressure_b_pa - return_pa, smoothing_pa),
        )
    if gain < 0.0:
        return (
            gain * signed_root(pressure_a_pa - return_pa, smoothing_pa),
            -gain * signed_root(supply_pa - pressure_b_pa, smoothing_pa),
        )
    return 0.0, 0.0


@kernel
def pushing_only(pressure_pa: float) -> float:
    """A pressure below zero is zero, because oil cannot pull; a NaN stays a NaN."""
    if pressure_pa < 0.0:
        return 0.0
    return pressure_pa


@kernel
def chamber_step(
    link: LinkParams,
    state: LinkState,
    flows_m3_per_s: tuple[float, float],
    ends_pa: tuple[float, float],
    step_s: float,
) -> tuple[float, float]:
    """Pressures of both chambers after a step, never below zero; `ends_pa` are supply and return.

    Pa' = beta / Va (Qa - Cl (Pa - Pb) + Cn (Ps - 2 Pa + Pr) - D v),    Va = V0 + D (q - q_low)
    Pb' = beta / Vb (Qb + Cl (Pa - Pb) + Cn (Ps - 2 Pb + Pr) + r D v),  Vb = V0 + r D (q_high - q),  r = Db / Da
    """
    a_pa, b_pa = state.pressure_a_pa, state.pressure_b_pa
    displacement = link.displacement_m3_per_q
    leak = link.cross_leak_m3_per_s_pa * (a_pa - b_pa)
    swept = displacement * state.qd
    rod_side = link.area_ratio * displacement
    ends = ends_pa[0] + ends_pa[1]
    into_a = flows_m3_per_s[0] - leak + link.null_leak_m3_per_s_pa * (ends - 2.0 * a_pa) - swept
    into_b = flows_m3_per_s[1] + leak + link.null_leak_m3_per_s_pa * (ends - 2.0 * b_pa) + link.area_ratio * swept
    stiffness = step_s * link.bulk_modulus_pa
    a_pa += stiffness * into_a / (link.dead_volume_m3 + displacement * (state.q - link.travel_low_q))
    b_pa += stiffness * into_b / (link.dead_volume_m3 + rod_side * (link.travel_high_q - state.q))
    return pushing_only(a_pa), pushing_only(b_pa)
