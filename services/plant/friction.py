"""Dry friction as a projection of velocity: what stands stands exactly, whatever the step."""

import math

from hydrohil.services.plant.params import LinkParams
from hydrohil.shared.compiled.kernel import kernel


@kernel
def friction_limit(link: LinkParams, speed_rad_per_s: float) -> float:
    """Largest dry friction in N m:  F(v) = Fc + (Fs - Fc) exp(-(v / vs)^2),  Fs at v = 0  (Stribeck)."""
    if speed_rad_per_s == 0.0:
        return link.breakaway_nm
    ratio = speed_rad_per_s / link.stribeck_rad_per_s
    return link.coulomb_nm + (link.breakaway_nm - link.coulomb_nm) * math.exp(-(ratio * ratio))


@kernel
def slide(speed_rad_per_s: float, inertia_kg_m2: float, load_nm: float, limit_nm: float, step_s: float) -> float:
    """Speed after a step under `load_nm` and dry friction of at most `limit_nm` (Moreau's time stepping, Karnopp's model).

    Friction takes the momentum M v + h tau to exactly zero if h limit suffices; otherwise it takes h limit of it.
    """
    momentum = inertia_kg_m2 * speed_rad_per_s + step_s * load_nm
    taken = step_s * limit_nm
    if abs(momentum) <= taken:
        return 0.0
    if momentum > 0.0:
        return (momentum - taken) / inertia_kg_m2
    return (momentum + taken) / inertia_kg_m2  # and a NaN stays one
