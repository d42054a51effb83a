"""The final nonlinear PI law: Morse control, VETIA, and braking ahead of the set-point's stop (thesis 4.6)."""

from hydrohil.services.controller.laws.law import Law, LawAnswer, LinkLawState, LinkSignals
from hydrohil.services.controller.laws.parts import boosted_integral, morse_factor, next_state, position_error
from hydrohil.services.controller.params import LinkGains
from hydrohil.shared.compiled.kernel import kernel


@kernel
def braking_acceleration(gains: LinkGains, qd_set: float, last_qd_set: float, dt_s: float) -> float:
    """Set-point acceleration where it opposes the set-point velocity, clipped; otherwise 0 (4.6)."""
    if dt_s <= 0.0:
        return 0.0
    acceleration = (qd_set - last_qd_set) / dt_s
    clip = gains.braking_clip_q_per_s2
    if acceleration > 0.0 and qd_set < 0.0:
        return clip if acceleration > clip else acceleration
    if acceleration < 0.0 and qd_set > 0.0:
        return -clip if acceleration < -clip else acceleration
    return 0.0


@kernel
def braked_step(state: LinkLawState, gains: LinkGains, signals: LinkSignals, ka_a_s_per_q: float) -> LawAnswer:
    """u = K_P e + I,  I = (I + (K_I e + K_a q''_braking) dt) a / (a + e'^2),  with VETIA's boost."""
    e, dt_s = position_error(gains, signals), signals.dt_s
    integral_a = state.integral_a + gains.ki_a_per_q_s * e * dt_s
    integral_a += ka_a_s_per_q * braking_acceleration(gains, signals.qd_set, state.qd_set, dt_s) * dt_s
    integral_a *= morse_factor(gains, signals.qd, signals.qd_set)
    current_a = gains.kp_a_per_q * e + integral_a
    integral_a, armed, boosted = boosted_integral(state, gains, signals, integral_a, current_a)
    return next_state(state, signals, integral_a, armed, state.relay), current_a, boosted


@kernel
def final_step(state: LinkLawState, gains: LinkGains, signals: LinkSignals) -> LawAnswer:
    """`braked_step` with the thesis' K_a."""
    return braked_step(state, gains, signals, gains.ka_a_s_per_q)


FINAL = Law("final", final_step)
