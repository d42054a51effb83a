"""Channels of a trace, and the small steps that several metrics share."""

from itertools import pairwise
from typing import Literal, get_args

import numpy as np

from hydrohil.claims.trace import Integers, Reals, Trace
from hydrohil.shared.machine.unimate import UNIMATE

ChannelName = Literal["q1", "q2", "q3", "x", "y", "z", "force"]
JOINTS: tuple[ChannelName, ...] = ("q1", "q2", "q3")
AXES: tuple[ChannelName, ...] = ("x", "y", "z")
CHANNELS: tuple[ChannelName, ...] = get_args(ChannelName)

_ROTATE, _DOWN_UP, _OUT_IN, _, _ = UNIMATE.encoders
COUNT_Q = (abs(_ROTATE.scale), abs(_DOWN_UP.scale), abs(_OUT_IN.scale))  # third in m
NAN = float("nan")  # a window that does not determine a number
TAIL = 0.1  # the last tenth of a window gives its final value
STILL = 1e-9  # a set-point that changes by less from sample to sample stands still (rad, m, N)


def measured(trace: Trace, channel: ChannelName) -> Reals:
    """(n,) what the rig read on `channel`."""
    if channel == "force":
        return trace.force_n
    if channel in JOINTS:
        return trace.q[:, JOINTS.index(channel)]
    return trace.x_m[:, AXES.index(channel)]


def set_point(trace: Trace, channel: ChannelName) -> Reals:
    """(n,) the set-point of `channel`: q_s, the modified x_s, or F_d."""
    if channel == "force":
        return trace.force_set_n
    if channel in JOINTS:
        return trace.q_set[:, JOINTS.index(channel)]
    return trace.x_set_m[:, AXES.index(channel)]


def nominal(trace: Trace, axis: ChannelName) -> Reals:
    """(n,) the reference of an axis before the target impedance modified it."""
    return trace.x_nominal_m[:, AXES.index(axis)]


def error(trace: Trace, channel: ChannelName) -> Reals:
    """(n,) set-point minus measured."""
    return set_point(trace, channel) - measured(trace, channel)


def control(trace: Trace, link: ChannelName) -> Reals:
    """(n,) current in A that the law commands a link's valve."""
    return trace.current_a[:, JOINTS.index(link)]


def count_size(link: ChannelName) -> float:
    """Resolution of a link's encoder in rad (link 3: m)."""
    return COUNT_Q[JOINTS.index(link)]


def final_value(values: Reals) -> float:
    """Mean over the last tenth."""
    return float(np.mean(values[-max(1, int(len(values) * TAIL)) :]))


def rms(values: Reals) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def alternations(values: Reals, low: float, high: float) -> Integers:
    """(m,) rows at which `values` reaches the opposite side, above `high` or below `low`; in between counts for neither."""
    sides = np.where(values > high, 1, np.where(values < low, -1, 0))
    outside = np.flatnonzero(sides)
    changes = np.flatnonzero(np.diff(sides[outside]))
    return np.asarray(outside[changes + 1], dtype=np.int64)


def swings(values: Reals, least: float) -> int:
    """How often `values` turns round and goes more than `least` the other way; the first such way counts too."""
    low = high = float(values[0])
    direction, count = 0, 0
    for value in values.tolist():
        low, high = min(low, value), max(high, value)
        if direction <= 0 and value - low > least:
            direction, count, high = 1, count + 1, value
        elif direction >= 0 and high - value > least:
            direction, count, low = -1, count + 1, value
    return count


def moves(values: Reals) -> list[tuple[int, int, float]]:
    """Moves of a set-point as (row at which it starts, row at which the next starts, direction).

    A move starts where the set-point leaves rest or turns round.
    """
    steps = np.diff(values)
    directions = np.where(np.abs(steps) > STILL, np.sign(steps), 0.0)
    before = np.concatenate(([0.0], directions[:-1]))
    starts = np.flatnonzero((directions != 0.0) & (directions != before))
    bounds = [*starts, len(values)]
    return [(int(start), int(end), float(directions[start])) for start, end in pairwise(bounds)]
