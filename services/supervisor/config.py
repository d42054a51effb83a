"""What an experiment may say to the supervisor. Limits may be tightened, never widened beyond the defaults' bounds."""

from typing import Annotated, NamedTuple

from annotated_types import Interval

from hydrohil.shared.units import RAD_PER_DEG

LB_LIMIT_N = 75.0 * 9.8 / 2.2  # "exits above 75 lb", 334 N (Appendix F)


class JointSpeedLimits(NamedTuple):
    """Rad/s, rad/s and m/s: a quarter above what the valves pass."""

    rotate: Annotated[float, Interval(gt=0.0, le=30 * RAD_PER_DEG)] = 30 * RAD_PER_DEG
    down_up: Annotated[float, Interval(gt=0.0, le=30 * RAD_PER_DEG)] = 30 * RAD_PER_DEG
    out_in: Annotated[float, Interval(gt=0.0, le=0.5)] = 0.5


class JointLowLimits(NamedTuple):
    """Lower ends of the permitted travel in rad, rad and m."""

    rotate: Annotated[float, Interval(ge=-110 * RAD_PER_DEG)] = -110 * RAD_PER_DEG
    down_up: Annotated[float, Interval(ge=-30 * RAD_PER_DEG)] = -30 * RAD_PER_DEG
    out_in: Annotated[float, Interval(ge=-0.002)] = -0.002


class JointHighLimits(NamedTuple):
    """Upper ends of the permitted travel in rad, rad and m."""

    rotate: Annotated[float, Interval(le=110 * RAD_PER_DEG)] = 110 * RAD_PER_DEG
    down_up: Annotated[float, Interval(le=27 * RAD_PER_DEG)] = 27 * RAD_PER_DEG
    out_in: Annotated[float, Interval(le=1.04)] = 1.04


class SupervisorConfig(NamedTuple):
    """Section [supervisor] of an experiment: what must hold while the machine may move."""

    force_limit_n: Annotated[float, Interval(gt=0.0, le=LB_LIMIT_N)] = LB_LIMIT_N  # on tared force
    raw_force_limit_n: Annotated[float, Interval(gt=0.0, le=LB_LIMIT_N + 60.0)] = LB_LIMIT_N + 60.0  # on raw force
    bias_limit_n: Annotated[float, Interval(gt=0.0, le=60.0)] = 60.0
    bias_spread_n: Annotated[float, Interval(gt=0.0, le=20.0)] = 15.0  # largest standard deviation of a steady gauge
    # The rate at which 111 kg of arm, still to be stopped by the stiffest contact (57.6 and 46 kN/m in series), reach the force
    # limit with the valves already shut: 334 N sqrt(k / m) = 5070 N/s.
    force_rate_limit_n_per_s: Annotated[float, Interval(gt=0.0, le=5000.0)] = 5000.0
    # Above 300 N less is left than noise and one encoder count on the stiffest contact need (10 and 25 N): a law that stays
    # there is no longer regulating. The longest blow of the thesis is over within half a second.
    contact_level_n: Annotated[float, Interval(gt=0.0, le=300.0)] = 300.0
    contact_time_s: Annotated[float, Interval(gt=0.0, le=1.0)] = 1.0
    contact_energy_j: Annotated[float, Interval(gt=0.0, le=100.0)] = 100.0  # 334 N over 0.3 m, as far as the crate is pushed
    joint_speed_limit_q_per_s: JointSpeedLimits = JointSpeedLimits()
    tip_speed_limit_m_per_s: Annotated[float, Interval(gt=0.0, le=0.75)] = 0.75  # one link at 24 deg/s and full reach
    joint_low_q: JointLowLimits = JointLowLimits()
    joint_high_q: JointHighLimits = JointHighLimits()
    workspace_low_m: tuple[
        Annotated[float, Interval(ge=-2.0)], Annotated[float, Interval(ge=-2.0)], Annotated[float, Interval(ge=-1.6)]
    ] = (-2.0, -2.0, -1.6)
    workspace_high_m: tuple[
        Annotated[float, Interval(le=2.0)], Annotated[float, Interval(le=2.0)], Annotated[float, Interval(le=0.8)]
    ] = (2.0, 2.0, 0.8)
