"""Dry friction as a projection of velocity: what stands stands exactly, whatever the step."""

import math

from hydrohil.services.plant.params import LinkParams
from hydrohil.shared.compiled.kernel import kernel


@kernel
def friction_limit(link: LinkParams, speed_q_per_s: float) -> float:
    """Largest dry friction (N m | N):  F(v) = Fc + (Fs - Fc) exp(-(v / vs)^2),  Fs at v = 0  (Stribeck)."""
    if speed_q_per_s == 0.0:
        return link.breakaway_tau
    ratio = speed_q_per_s / link.stribeck_q_per_s
    return link.coulomb_tau + (link.breakaway_tau - link.coulomb_tau) * math.exp(-(ratio * ratio))


@kernel
def slide(speed_q_per_s: float, inertia_tau_s2_per_q: float, load_tau: float, limit_tau: float, step_s: float) -> float:
    """Speed after a step under `load_tau` and dry friction of at most `limit_tau` (Moreau's time stepping, Karnopp's model).

    Friction takes the momentum M v + h tau to exactly zero if h limit suffices; otherwise it takes h limit of it.
    """
    momentum = inertia_tau_s2_per_q * speed_q_per_s + step_s * load_tau
    taken = step_s * limit_tau
    if abs(momentum) <= taken:
        return 0.0
    if momentum > 0.0:
        return (momentum - taken) / inertia_tau_s2_per_q
    return (momentum + taken) / inertia_tau_s2_per_q  # and a NaN stays a NaN
