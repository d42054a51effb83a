"""Parts that several laws share. Order of operations as in the program of Appendix F (`morse_cont`)."""

from hydrohil.services.controller.laws.law import LinkLawState, LinkSignals
from hydrohil.services.controller.params import LinkGains
from hydrohil.shared.compiled.kernel import kernel

ALPHA_FLOOR = 0.001  # 4.4, alpha at rest as a share of alpha_max


@kernel
def position_error(gains: LinkGains, signals: LinkSignals) -> float:
    """e = q_s - q, zero inside the dead zone while the set-point is slow (against random walk of the integral, 4.3)."""
    e = signals.q_set - signals.q
    if abs(e) < gains.error_dead_zone_q and abs(signals.qd_set) < gains.dead_zone_speed_q_per_s:
        return 0.0
    return e


@kernel
def morse_factor(gains: LinkGains, qd: float, qd_set: float) -> float:
    """a / (a + e'^2),  a = alpha_max (0.001 + |q_s'| / q'_max): resets the integral where it could wind up (4.4)."""
    alpha = gains.alpha_max_q2_per_s2 * (ALPHA_FLOOR + abs(qd_set / gains.qd_max_q_per_s))
    ed = qd_set - qd
    return alpha / (alpha + ed * ed)


@kernel
def morse_integral(state: LinkLawState, gains: LinkGains, signals: LinkSignals, e: float) -> float:
    """I = (I + K_I e dt) a / (a + e'^2)  (4.4)."""
    return (state.integral_a + gains.ki_a_per_q_s * e * signals.dt_s) * morse_factor(gains, signals.qd, signals.qd_set)


@kernel
def peak_speed(state: LinkLawState, qd_set: float) -> float:
    """Largest set-point speed since the set-point last stood or turned round: the size of the motion that is braked."""
    speed = abs(qd_set)
    if state.peak_q_per_s > speed and qd_set * state.qd_set > 0.0:
        return state.peak_q_per_s
    return speed


@kernel
def stiction_rate(gains: LinkGains, qd: float, qd_set: float) -> float:
    """Velocity error caused by stiction,  (q_s' - q') q_s'^2 / (q_s'^2 + beta q'^2 + eps)  (4.5.3, `anti_stick_boost`)."""
    square = qd_set * qd_set
    return (qd_set - qd) * square / (square + gains.stiction_selectivity * qd * qd + gains.stiction_epsilon_q2_per_s2)


@kernel
def boosted_integral(
    state: LinkLawState, gains: LinkGains, signals: LinkSignals, integral_a: float, current_a: float
) -> tuple[float, int, int]:
    """VETIA: (integral, armed, boosted). Once per stiction event the integral jumps to what breaks away (4.5.4).

    The program's algebra: it fires below `boost_below_a`, boosts beyond it, and the boost acts one sample later.
    """
    armed, rate = state.boost_armed, stiction_rate(gains, signals.qd, signals.qd_set)
    if rate > gains.stiction_rate_min_q_per_s:
        if armed == 1 and current_a < gains.boost_below_a:
            return integral_a + (gains.boost_positive_a - current_a), 0, 1
        return integral_a, armed, 0
    if rate < -gains.stiction_rate_min_q_per_s:
        if armed == 1 and current_a > -gains.boost_below_a:
            return integral_a + (-gains.boost_negative_a - current_a), 0, 1
        return integral_a, armed, 0
    return integral_a, 1, 0


@kernel
def next_state(state: LinkLawState, signals: LinkSignals, integral_a: float, boost_armed: int, relay: int) -> LinkLawState:
    """What is carried on: the law's own memory, and what every law remembers of the set-point's motion."""
    return LinkLawState(
        integral_a=integral_a,
        boost_armed=boost_armed,
        qd_set=signals.qd_set,
        relay=relay,
        peak_q_per_s=peak_speed(state, signals.qd_set),
    )
