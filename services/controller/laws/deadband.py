"""Modified Morse control with a current that compensates the valve's dead band (thesis 4.5.1)."""

from hydrohil.services.controller.laws.law import Law, LawAnswer, LinkLawState, LinkSignals
from hydrohil.services.controller.laws.morse import morse_step
from hydrohil.services.controller.params import LinkGains
from hydrohil.shared.compiled.kernel import kernel


@kernel
def deadband_compensation(gains: LinkGains, current_a: float) -> float:
    """u_c = U+ above U_L, U- below -U_L, linear between (4.5.1; the figure is lost, linear is this rig's reading)."""
    share = current_a / gains.deadband_width_a
    if share > 1.0:
        return gains.deadband_positive_a
    if share < -1.0:
        return -gains.deadband_negative_a
    return share * (gains.deadband_positive_a if share > 0.0 else gains.deadband_negative_a)


@kernel
def deadband_step(state: LinkLawState, gains: LinkGains, signals: LinkSignals) -> LawAnswer:
    """u + u_c(u)  with the u of Morse control, whose integral does not see what is added."""
    after, current_a, boosted = morse_step(state, gains, signals)
    return after, current_a + deadband_compensation(gains, current_a), boosted


@kernel
def before_deadband(state: LinkLawState, gains: LinkGains, signals: LinkSignals, current_a: float) -> tuple[float, int]:
    """The u with which u + u_c(u) is `current_a`."""
    added_a = gains.deadband_positive_a if current_a > 0.0 else -gains.deadband_negative_a
    if abs(current_a) > gains.deadband_width_a + abs(added_a):
        return current_a - added_a, state.relay
    return current_a / (1.0 + abs(added_a) / gains.deadband_width_a), state.relay


DEADBAND = Law("deadband", deadband_step, before_deadband)
