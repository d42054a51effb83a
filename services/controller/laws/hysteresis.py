"""Modified Morse control with a dead band compensation that a relay switches (thesis 4.5.2)."""

from hydrohil.services.controller.laws.law import Law, LawAnswer, LinkLawState, LinkSignals
from hydrohil.services.controller.laws.morse import morse_step
from hydrohil.services.controller.laws.parts import next_state
from hydrohil.services.controller.params import LinkGains
from hydrohil.shared.compiled.kernel import kernel


@kernel
def relay_sign(gains: LinkGains, relay: int, current_a: float) -> int:
    """Sign of the compensation with hysteresis: +1 above h, -1 below -h, unchanged between.

    The thesis' text on 4.5.2 is lost; a relay with hysteresis is this rig's reading of its title.
    """
    if current_a > gains.hysteresis_a:
        return 1
    if current_a < -gains.hysteresis_a:
        return -1
    return relay


@kernel
def relay_current(gains: LinkGains, sign: int) -> float:
    """What the relay adds: U+, U-, or nothing before it has switched."""
    if sign == 0:
        return 0.0
    return gains.deadband_positive_a if sign == 1 else -gains.deadband_negative_a


@kernel
def hysteresis_step(state: LinkLawState, gains: LinkGains, signals: LinkSignals) -> LawAnswer:
    """u of Morse control, and U+ or U- by the sign of the relay."""
    after, current_a, boosted = morse_step(state, gains, signals)
    sign = relay_sign(gains, state.relay, current_a)
    after = next_state(state, signals, after.integral_a, after.boost_armed, sign)
    return after, current_a + relay_current(gains, sign), boosted


@kernel
def before_relay(state: LinkLawState, gains: LinkGains, signals: LinkSignals, current_a: float) -> tuple[float, int]:
    """The u and the relay's sign with which the law gives `current_a`; where the relay leaps over it, its own level."""
    h = gains.hysteresis_a
    if abs(current_a) <= h:
        return current_a, 0
    sign = 1 if current_a > 0.0 else -1
    rest_a = current_a - relay_current(gains, sign)
    return (rest_a if rest_a * sign > -h else 0.0), sign


HYSTERESIS = Law("hysteresis", hysteresis_step, before_relay)
