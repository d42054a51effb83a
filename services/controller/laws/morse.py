"""Modified Morse control: an integral that velocity errors reset (thesis 4.4)."""

from hydrohil.services.controller.laws.law import Law, LawAnswer, LinkLawState, LinkSignals
from hydrohil.services.controller.laws.parts import morse_integral, next_state, position_error
from hydrohil.services.controller.params import LinkGains
from hydrohil.shared.compiled.kernel import kernel


@kernel
def morse_step(state: LinkLawState, gains: LinkGains, signals: LinkSignals) -> LawAnswer:
    """u = K_P e + I,  I = (I + K_I e dt) a / (a + e'^2)."""
    e = position_error(gains, signals)
    integral_a = morse_integral(state, gains, signals, e)
    return next_state(state, signals, integral_a, state.boost_armed, state.relay), gains.kp_a_per_q * e + integral_a, 0


MORSE = Law("morse", morse_step)
