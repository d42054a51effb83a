"""Position laws of one link: PI, modified Morse, deadband compensation, VETIA and the final NPI law (thesis 4.3 to 4.6).

Beyond the thesis, each the final law with one change: robust overshoot reduction (9.2.1) and a load fed forward (9.2.2).

Order of operations as in the program (`morse_cont`). The integral is kept as current: I here is K_I I of the thesis.
Positive is down and out. Link 3 reads m for rad.
"""

from typing import NamedTuple

from hydrohil.services.controller.params import (
    LAW_DEADBAND,
    LAW_FINAL,
    LAW_HYSTERESIS,
    LAW_PI,
    LAW_ROBUST,
    LAW_TORQUE,
    LAW_VETIA,
    LinkGains,
)
from hydrohil.shared.compiled.kernel import kernel

ALPHA_FLOOR = 0.001  # 4.4, alpha at rest as a share of alpha_max


class LinkLawState(NamedTuple):
    """What one link's law carries from sample to sample."""

    integral_a: float = 0.0
    boost_armed: int = 1  # 0 = this stiction event has had its boost
    qd_set: float = 0.0  # of the last sample, for the braking acceleration
    relay: int = 0  # sign of the hysteretic compensation
    peak_q_per_s: float = 0.0  # largest set-point speed since it last stood or turned round


AT_REST = LinkLawState()


@kernel
def position_error(gains: LinkGains, q: float, q_set: float, qd_set: float) -> float:
    """e = q_s - q, zero inside the dead zone while the set-point is slow (against random walk of the integral, 4.3)."""
    e = q_set - q
    if abs(e) < gains.error_dead_zone_q and abs(qd_set) < gains.dead_zone_speed_q_per_s:
        return 0.0
    return e


@kernel
def morse_factor(gains: LinkGains, qd: float, qd_set: float) -> float:
    """a / (a + e'^2),  a = alpha_max (0.001 + |q_s'| / q'_max): resets the integral where it could wind up (4.4)."""
    alpha = gains.alpha_max_q2_per_s2 * (ALPHA_FLOOR + abs(qd_set / gains.qd_max_q_per_s))
    ed = qd_set - qd
    return alpha / (alpha + ed * ed)


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
def peak_speed(state: LinkLawState, qd_set: float) -> float:
    """Largest set-point speed since the set-point last stood or turned round: the size of the motion that is braked."""
    speed = abs(qd_set)
    if state.peak_q_per_s > speed and qd_set * state.qd_set > 0.0:
        return state.peak_q_per_s
    return speed


@kernel
def braking_gain(gains: LinkGains, law: int, peak_q_per_s: float) -> float:
    """K_a; of the robust law max(K_a, U_b / v): braking from v to rest takes K_a v, and never less than U_b (9.2.1).

    Any motion, however slow, needs the valve's threshold current, which K_a v forgets. Below e_min nothing was boosted
    and K_a stays: a set-point that the force's noise moves would otherwise drain the integral again and again.
    """
    if law != LAW_ROBUST or peak_q_per_s <= gains.stiction_rate_min_q_per_s:
        return gains.ka_a_s_per_q
    if gains.ka_a_s_per_q * peak_q_per_s < gains.braking_least_a:
        return gains.braking_least_a / peak_q_per_s
    return gains.ka_a_s_per_q


@kernel
def load_feedforward(gains: LinkGains, law: int, load_tau: float) -> float:
    """-k_tau tau: current against the load tau = J^T f that the environment puts on the link, positive down and out (9.2.2).

    Added behind the law, so that a boost breaks away from what the load leaves to overcome: less where it aids the motion.
    """
    return -gains.load_feedforward_a_per_tau * load_tau if law == LAW_TORQUE else 0.0


@kernel
def stiction_rate(gains: LinkGains, qd: float, qd_set: float) -> float:
    """Velocity error caused by stiction,  (q_s' - q') q_s'^2 / (q_s'^2 + beta q'^2 + eps)  (4.5.3, `anti_stick_boost`)."""
    square = qd_set * qd_set
    return (qd_set - qd) * square / (square + gains.stiction_selectivity * qd * qd + gains.stiction_epsilon_q2_per_s2)


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
def boosted_integral(gains: LinkGains, armed: int, rate: float, integral_a: float, current_a: float) -> tuple[float, int, int]:
    """VETIA: (integral, armed, boosted). Once per stiction event the integral jumps to what breaks away (4.5.4).

    The program's algebra: it fires below `boost_below_a`, boosts beyond it, and the boost acts one sample later.
    """
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
def compensation(gains: LinkGains, law: int, relay: int, current_a: float) -> tuple[float, int]:
    """Current that deadband compensation adds, and the relay's sign."""
    if law == LAW_DEADBAND:
        return deadband_compensation(gains, current_a), relay
    if law == LAW_HYSTERESIS:
        sign = relay_sign(gains, relay, current_a)
        if sign == 0:
            return 0.0, sign
        return (gains.deadband_positive_a if sign == 1 else -gains.deadband_negative_a), sign
    return 0.0, relay


@kernel
def relayed(gains: LinkGains, current_a: float) -> tuple[float, int]:
    """(current before a relay's compensation, the relay's sign) that give `current_a`; where it leaps, its own level."""
    h = gains.hysteresis_a
    if abs(current_a) <= h:
        return current_a, 0
    sign = 1 if current_a > 0.0 else -1
    rest_a = current_a - (gains.deadband_positive_a if sign == 1 else -gains.deadband_negative_a)
    return (rest_a if rest_a * sign > -h else 0.0), sign


@kernel
def uncompensated(gains: LinkGains, law: int, relay: int, current_a: float) -> tuple[float, int]:
    """(current before `compensation`, the relay's sign) that give `current_a` with it."""
    if law == LAW_HYSTERESIS:
        return relayed(gains, current_a)
    if law != LAW_DEADBAND:
        return current_a, relay
    added_a = gains.deadband_positive_a if current_a > 0.0 else -gains.deadband_negative_a
    if abs(current_a) > gains.deadband_width_a + abs(added_a):
        return current_a - added_a, relay
    return current_a / (1.0 + abs(added_a) / gains.deadband_width_a), relay


@kernel
def take_over(
    state: LinkLawState, gains: LinkGains, law: int, q: float, q_set: float, qd_set: float, load_tau: float, held_a: float
) -> LinkLawState:
    """A law that begins, or has other gains, where the valve stands at `held_a`: I so that  K_P e + I  gives just that.

    Bumpless transfer: the state of the new controller is set so that its output is what the actuator really has (Hanus,
    Kinnaert, Henrotte 1987, conditioning); for other gains it keeps P + I (Astrom, Hagglund 1995, bumpless parameter changes).
    """
    current_a, relay = uncompensated(gains, law, state.relay, held_a - load_feedforward(gains, law, load_tau))
    integral_a = current_a - gains.kp_a_per_q * position_error(gains, q, q_set, qd_set)
    return LinkLawState(integral_a, state.boost_armed, qd_set, relay, peak_speed(state, qd_set))


@kernel
def law_step(
    state: LinkLawState, gains: LinkGains, law: int, q: float, q_set: float, qd: float, qd_set: float, dt_s: float
) -> tuple[LinkLawState, float, int]:
    """u = K_P e + I with I = (I + (K_I e + K_a q''_braking) dt) a / (a + e'^2): (state, current in A, 1 if boosted)."""
    e = position_error(gains, q, q_set, qd_set)
    peak = peak_speed(state, qd_set)
    if law == LAW_PI:
        integral = state.integral_a + gains.linear_ki_a_per_q_s * e * dt_s
    else:
        integral = state.integral_a + gains.ki_a_per_q_s * e * dt_s
        if law in (LAW_FINAL, LAW_ROBUST, LAW_TORQUE):
            braking = braking_acceleration(gains, qd_set, state.qd_set, dt_s)
            integral += braking_gain(gains, law, peak) * braking * dt_s
        integral *= morse_factor(gains, qd, qd_set)
    current_a = gains.kp_a_per_q * e + integral
    added_a, relay = compensation(gains, law, state.relay, current_a)
    armed, boosted = state.boost_armed, 0
    if law in (LAW_VETIA, LAW_FINAL, LAW_ROBUST, LAW_TORQUE):
        rate = stiction_rate(gains, qd, qd_set)
        integral, armed, boosted = boosted_integral(gains, armed, rate, integral, current_a)
    return LinkLawState(integral, armed, qd_set, relay, peak), current_a + added_a, boosted
