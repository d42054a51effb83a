"""Linear PI control (thesis 4.3)."""

from hydrohil.services.controller.laws.law import Law, LawAnswer, LinkLawState, LinkSignals
from hydrohil.services.controller.laws.parts import next_state, position_error
from hydrohil.services.controller.params import LinkGains
from hydrohil.shared.compiled.kernel import kernel


@kernel
def pi_step(state: LinkLawState, gains: LinkGains, signals: LinkSignals) -> LawAnswer:
    """u = K_P e + I,  I = I + K_I e dt  with the K_I of the linear law."""
    e = position_error(gains, signals)
    integral_a = state.integral_a + gains.linear_ki_a_per_q_s * e * signals.dt_s
    return next_state(state, signals, integral_a, state.boost_armed, state.relay), gains.kp_a_per_q * e + integral_a, 0


PI = Law("pi", pi_step)
