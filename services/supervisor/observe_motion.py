"""What the encoders say besides the pose: steps, smooth speeds, and whether each link goes where its current drives it."""

import math
from typing import NamedTuple

from hydrohil.services.supervisor.rule import MotionObservation
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import LinkCounts
from hydrohil.shared.machine.description import Triple

SMOOTHING_S = 0.02
AT_STOP_COUNTS = 2.0


class LinkProgress(NamedTuple):
    """One link under a current that must move it."""

    sign: int  # of that current; 0 = none
    furthest_q: float  # the furthest position that it has reached in that direction
    idle_ns: int  # since it reached that position


class MotionMemory(NamedTuple):
    """What is remembered of the motion."""

    q: Triple
    pitch_rad: float
    tip_m: Triple
    speed: Triple
    tip_m_per_s: Triple
    rotate: LinkProgress
    down_up: LinkProgress
    out_in: LinkProgress


class DriveCodes(NamedTuple):
    """D/A codes at and beyond which a link must move, the size of a count, and where its stops are."""

    low: LinkCounts
    high: LinkCounts
    count_q: Triple
    travel_low: Triple
    travel_high: Triple


class Pose(NamedTuple):
    """Where the encoders say that the arm is."""

    counts: tuple[int, int, int]
    q: Triple
    pitch_rad: float
    tip_m: Triple


@kernel
def smooth_speed(speed: float, moved: float, dt_s: float) -> float:
    """v += (dx - v dt) / (tau + dt); starts from 0 after a NaN, so that one bad sample is not remembered."""
    if speed != speed:
        speed = 0.0
    return speed + (moved - speed * dt_s) / (SMOOTHING_S + dt_s)


@kernel
def _speeds(speeds: Triple, now: Triple, before: Triple, dt_s: float) -> Triple:
    return (
        smooth_speed(speeds[0], now[0] - before[0], dt_s),
        smooth_speed(speeds[1], now[1] - before[1], dt_s),
        smooth_speed(speeds[2], now[2] - before[2], dt_s),
    )


@kernel
def _driven(code: int, low: int, high: int, q: float, stops: tuple[float, float], near_q: float) -> int:
    """Sign of a current that must move the link: 0 for a current in between, and for one into a stop that it has reached."""
    if code >= high and not q >= stops[1] - near_q:
        return 1
    if code <= low and not q <= stops[0] + near_q:
        return -1
    return 0


@kernel
def link_step(progress: LinkProgress, sign: int, q: float, dt_ns: int) -> LinkProgress:
    """Time since the link last went further in the direction of its current; a count of chatter is no progress."""
    if sign == 0 or sign != progress.sign or sign * (q - progress.furthest_q) > 0.0:
        return LinkProgress(sign=sign, furthest_q=q, idle_ns=0)
    return LinkProgress(sign=sign, furthest_q=progress.furthest_q, idle_ns=progress.idle_ns + dt_ns)


@kernel
def against(progress: LinkProgress, q: float) -> float:
    """How far the link has gone against its current."""
    return progress.sign * (progress.furthest_q - q)


@kernel
def _link(progress: LinkProgress, codes: DriveCodes, dac_counts: LinkCounts, pose: Pose, link: int, dt_ns: int) -> LinkProgress:
    stops = (codes.travel_low[link], codes.travel_high[link])
    near_q = AT_STOP_COUNTS * codes.count_q[link]
    sign = _driven(dac_counts[link], codes.low[link], codes.high[link], pose.q[link], stops, near_q)
    return link_step(progress, sign, pose.q[link], dt_ns)


@kernel
def motion_begin(pose: Pose) -> MotionMemory:
    """Every window at its first pose."""
    none, still = LinkProgress(sign=0, furthest_q=0.0, idle_ns=0), (0.0, 0.0, 0.0)
    return MotionMemory(
        q=pose.q,
        pitch_rad=pose.pitch_rad,
        tip_m=pose.tip_m,
        speed=still,
        tip_m_per_s=still,
        rotate=none,
        down_up=none,
        out_in=none,
    )


@kernel
def motion_step(
    memory: MotionMemory, codes: DriveCodes, pose: Pose, dac_counts: LinkCounts, follows: bool, dt_ns: int
) -> tuple[MotionMemory, MotionObservation]:
    """Take one set of counters in; without a sample before, nothing has moved yet."""
    if not follows:
        memory = motion_begin(pose)
    dt_s = dt_ns * 1e-9
    q, before = pose.q, memory.q
    after = MotionMemory(
        q=q,
        pitch_rad=pose.pitch_rad,
        tip_m=pose.tip_m,
        speed=_speeds(memory.speed, q, before, dt_s),
        tip_m_per_s=_speeds(memory.tip_m_per_s, pose.tip_m, memory.tip_m, dt_s),
        rotate=_link(memory.rotate, codes, dac_counts, pose, 0, dt_ns),
        down_up=_link(memory.down_up, codes, dac_counts, pose, 1, dt_ns),
        out_in=_link(memory.out_in, codes, dac_counts, pose, 2, dt_ns),
    )
    tip = after.tip_m_per_s
    observed = MotionObservation(
        q=q,
        tip_m=pose.tip_m,
        counts=pose.counts,
        moved_q=(q[0] - before[0], q[1] - before[1], q[2] - before[2], pose.pitch_rad - memory.pitch_rad),
        dt_s=dt_s,
        speed=after.speed,
        tip_speed_m_per_s=math.sqrt(tip[0] * tip[0] + tip[1] * tip[1] + tip[2] * tip[2]),
        idle_ns=(after.rotate.idle_ns, after.down_up.idle_ns, after.out_in.idle_ns),
        against=(against(after.rotate, q[0]), against(after.down_up, q[1]), against(after.out_in, q[2])),
    )
    return after, observed
