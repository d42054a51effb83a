"""Beyond the thesis: the final law with an overshoot reduction that also holds at low speed (thesis 9.2.1)."""

from hydrohil.services.controller.laws.final import braked_step
from hydrohil.services.controller.laws.law import Law, LawAnswer, LinkLawState, LinkSignals
from hydrohil.services.controller.laws.parts import peak_speed
from hydrohil.services.controller.params import LinkGains
from hydrohil.shared.compiled.kernel import kernel


@kernel
def robust_braking_gain(gains: LinkGains, peak_q_per_s: float) -> float:
    """max(K_a, U_b / v): braking from v to rest takes K_a v, and never less than U_b (9.2.1).

    Any motion, however slow, needs the valve's threshold current, which K_a v forgets. Below e_min nothing was boosted
    and K_a stays: a set-point that the force's noise moves would otherwise drain the integral again and again.
    """
    if peak_q_per_s <= gains.stiction_rate_min_q_per_s:
        return gains.ka_a_s_per_q
    if gains.ka_a_s_per_q * peak_q_per_s < gains.braking_least_a:
        return gains.braking_least_a / peak_q_per_s
    return gains.ka_a_s_per_q


@kernel
def robust_step(state: LinkLawState, gains: LinkGains, signals: LinkSignals) -> LawAnswer:
    """`braked_step` with a K_a that depends on the speed of the motion that is braked."""
    return braked_step(state, gains, signals, robust_braking_gain(gains, peak_speed(state, signals.qd_set)))


ROBUST = Law("robust", robust_step)
