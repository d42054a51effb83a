"""Modified Morse control with VETIA, which boosts the integral of a link that sticks (thesis 4.5.3, 4.5.4)."""

from hydrohil.services.controller.laws.law import Law, LawAnswer, LinkLawState, LinkSignals
from hydrohil.services.controller.laws.parts import boosted_integral, morse_integral, next_state, position_error
from hydrohil.services.controller.params import LinkGains
from hydrohil.shared.compiled.kernel import kernel


@kernel
def vetia_step(state: LinkLawState, gains: LinkGains, signals: LinkSignals) -> LawAnswer:
    """u = K_P e + I  with the I of Morse control, which a boost changes for the next sample."""
    e = position_error(gains, signals)
    integral_a = morse_integral(state, gains, signals, e)
    current_a = gains.kp_a_per_q * e + integral_a
    integral_a, armed, boosted = boosted_integral(state, gains, signals, integral_a, current_a)
    return next_state(state, signals, integral_a, armed, state.relay), current_a, boosted


VETIA = Law("vetia", vetia_step)
