"""What an experiment may say to the supervisor. Limits may be tightened, never widened beyond the defaults' bounds."""

from typing import Annotated, NamedTuple

from annotated_types import Interval

from shared.units import RAD_PER_DEG

LB_LIMIT_N = 75.0 * 9.8 / 2.2  # "exits above 75 lb", 334 N (Appendix F)


class SupervisorConfig(NamedTuple):
    """Section [supervisor] of an experiment: what must hold while the machine may move."""

    force_limit_n: Annotated[float, Interval(gt=0.0, le=LB_LIMIT_N)] = LB_LIMIT_N  # on tared force
    raw_force_limit_n: Annotated[float, Interval(gt=0.0, le=LB_LIMIT_N + 60.0)] = LB_LIMIT_N + 60.0  # on raw force
    bias_limit_n: Annotated[float, Interval(gt=0.0, le=60.0)] = 60.0
    bias_spread_n: Annotated[float, Interval(gt=0.0, le=20.0)] = 15.0  # largest standard deviation of a steady gauge
    joint_low_rad: tuple[
        Annotated[float, Interval(ge=-110 * RAD_PER_DEG)],
        Annotated[float, Interval(ge=-30 * RAD_PER_DEG)],
        Annotated[float, Interval(ge=-0.002)],
    ] = (-110 * RAD_PER_DEG, -30 * RAD_PER_DEG, -0.002)  # third in m
    joint_high_rad: tuple[
        Annotated[float, Interval(le=110 * RAD_PER_DEG)],
        Annotated[float, Interval(le=27 * RAD_PER_DEG)],
        Annotated[float, Interval(le=1.04)],
    ] = (110 * RAD_PER_DEG, 27 * RAD_PER_DEG, 1.04)
    workspace_low_m: tuple[
        Annotated[float, Interval(ge=-2.0)], Annotated[float, Interval(ge=-2.0)], Annotated[float, Interval(ge=-1.6)]
    ] = (-2.0, -2.0, -1.6)
    workspace_high_m: tuple[
        Annotated[float, Interval(le=2.0)], Annotated[float, Interval(le=2.0)], Annotated[float, Interval(le=0.8)]
    ] = (2.0, 2.0, 0.8)
