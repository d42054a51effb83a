"""What the encoders say beside the pose: steps, smooth speeds, and whether each link goes where its current drives it."""

import math
from typing import NamedTuple

from hydrohil.services.supervisor.machine import AT_STOP_COUNTS, TRAVEL_HIGH, TRAVEL_LOW
from hydrohil.services.supervisor.rule import MotionObservation
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import LinkCounts
from hydrohil.shared.contract.pose import Triple

SMOOTHING_S = 0.02


class LinkWatch(NamedTuple):
    """One link under a current that must move it."""

    sign: int  # of that current; 0 = none
    furthest_q: float  # where it has got to in that direction
    idle_ns: int  # since it last got further


class MotionWatch(NamedTuple):
    """What is remembered of the motion."""

    q: Triple
    pitch_rad: float
    tip_m: Triple
    speed: Triple
    tip_m_per_s: Triple
    rotate: LinkWatch
    down_up: LinkWatch
    out_in: LinkWatch


class Codes(NamedTuple):
    """D/A codes at and beyond which a link must move, and the size of a count."""

    low: LinkCounts
    high: LinkCounts
    count_q: Triple


class Pose(NamedTuple):
    """Where the encoders say that the arm is."""

    counts: tuple[int, int, int]
    q: Triple
    pitch_rad: float
    tip_m: Triple


@kernel
def smooth_speed(speed: float, moved: float, dt_s: float) -> float:
    """v += (dx - v dt) / (tau + dt); starts anew after a NaN, so that one bad sample is not remembered."""
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
    """Sign of a current that must move the link: none in between, and none into a stop that it stands at."""
    if code >= high and not q >= stops[1] - near_q:
        return 1
    if code <= low and not q <= stops[0] + near_q:
        return -1
    return 0


@kernel
def link_step(watch: LinkWatch, sign: int, q: float, dt_ns: int) -> LinkWatch:
    """Time since the link last got further in the direction of its current; a count of chatter is no progress."""
    if sign == 0 or sign != watch.sign or sign * (q - watch.furthest_q) > 0.0:
        return LinkWatch(sign, q, 0)
    return LinkWatch(sign, watch.furthest_q, watch.idle_ns + dt_ns)


@kernel
def against(watch: LinkWatch, q: float) -> float:
    """How far the link has gone against its current."""
    return watch.sign * (watch.furthest_q - q)


@kernel
def _link(watch: LinkWatch, codes: Codes, dac_counts: LinkCounts, pose: Pose, link: int, dt_ns: int) -> LinkWatch:
    stops = (TRAVEL_LOW[link], TRAVEL_HIGH[link])
    near_q = AT_STOP_COUNTS * codes.count_q[link]
    sign = _driven(dac_counts[link], codes.low[link], codes.high[link], pose.q[link], stops, near_q)
    return link_step(watch, sign, pose.q[link], dt_ns)


@kernel
def motion_begin(pose: Pose) -> MotionWatch:
    """Every window at its first pose."""
    none, still = LinkWatch(0, 0.0, 0), (0.0, 0.0, 0.0)
    return MotionWatch(pose.q, pose.pitch_rad, pose.tip_m, still, still, none, none, none)


@kernel
def motion_step(
    watch: MotionWatch, codes: Codes, pose: Pose, dac_counts: LinkCounts, follows: bool, dt_ns: int
) -> tuple[MotionWatch, MotionObservation]:
    """One set of counters taken in; without a sample before, nothing has moved yet."""
    if not follows:
        watch = motion_begin(pose)
    dt_s = dt_ns * 1e-9
    q, before = pose.q, watch.q
    speed = _speeds(watch.speed, q, before, dt_s)
    tip = _speeds(watch.tip_m_per_s, pose.tip_m, watch.tip_m, dt_s)
    rotate = _link(watch.rotate, codes, dac_counts, pose, 0, dt_ns)
    down_up = _link(watch.down_up, codes, dac_counts, pose, 1, dt_ns)
    out_in = _link(watch.out_in, codes, dac_counts, pose, 2, dt_ns)
    seen = MotionObservation(
        q,
        pose.tip_m,
        pose.counts,
        (q[0] - before[0], q[1] - before[1], q[2] - before[2], pose.pitch_rad - watch.pitch_rad),
        dt_s,
        speed,
        math.sqrt(tip[0] * tip[0] + tip[1] * tip[1] + tip[2] * tip[2]),
        (rotate.idle_ns, down_up.idle_ns, out_in.idle_ns),
        (against(rotate, q[0]), against(down_up, q[1]), against(out_in, q[2])),
    )
    return MotionWatch(q, pose.pitch_rad, pose.tip_m, speed, tip, rotate, down_up, out_in), seen
