"""Limit cycles of a link that jumps from rest to rest: when they begin, how large, how often, how regular."""

from typing import NamedTuple

import numpy as np

from hydrohil.claims.motion import MOTION_COUNTS
from hydrohil.claims.signals import COUNT_Q, JOINTS, NAN, ChannelName, count_size, measured, set_point
from hydrohil.claims.trace import Reals, Trace

COUNT_AT_1_M = COUNT_Q[1]  # what a count of the down/up link moves the tip by, in m, at the lever of 1 m


class Turn(NamedTuple):
    """One instant at which a signal that went one way goes the other."""

    row: int
    extreme: float  # where it turned


def turns(values: Reals, least: float) -> list[Turn]:
    """Every turn of `values` (n,) by more than `least`; the first is the first departure from where it began."""
    low = high = float(values[0])
    direction, found = 0, []
    for row, value in enumerate(values.tolist()):
        low, high = min(low, value), max(high, value)
        if direction <= 0 and value - low > least:
            found.append(Turn(row, low))
            direction, high = 1, value
        elif direction >= 0 and high - value > least:
            found.append(Turn(row, high))
            direction, low = -1, value
    return found


def _turns(trace: Trace, channel: ChannelName) -> list[Turn]:
    """Turns by two counts or more: a single one may be the edge of a step."""
    count = count_size(channel) if channel in JOINTS else COUNT_AT_1_M
    return turns(measured(trace, channel), MOTION_COUNTS * count)


def _intervals_s(trace: Trace, channel: ChannelName) -> Reals:
    """(m,) times between successive turns."""
    return np.diff(trace.t_s[[turn.row for turn in _turns(trace, channel)]])


def cycles(trace: Trace, channel: ChannelName) -> float:
    """How often the signal goes there and back after its first departure."""
    return float(max(0, (len(_turns(trace, channel)) - 1) // 2))


def cycle_amplitude(trace: Trace, channel: ChannelName) -> float:
    """Peak to peak of a cycle: median distance between successive turning points after the first departure; 0 without any."""
    extremes = [turn.extreme for turn in _turns(trace, channel)[1:]]
    return float(np.median(np.abs(np.diff(extremes)))) if len(extremes) > 1 else 0.0


def cycle_period_s(trace: Trace, channel: ChannelName) -> float:
    """Twice the median time between successive turns after the first departure."""
    intervals_s = _intervals_s(trace, channel)[1:]
    return 2.0 * float(np.median(intervals_s)) if len(intervals_s) else NAN


def cycle_onset_s(trace: Trace, channel: ChannelName) -> float:
    """From the window's start to the first turn that follows the first departure: that of the response to a step."""
    found = _turns(trace, channel)
    return float(trace.t_s[found[1].row] - trace.t_s[0]) if len(found) > 1 else NAN


def pause_ratio(trace: Trace, channel: ChannelName) -> float:
    """Longest time without a turn, from the second one to the window's end, over the median time between turns.

    0 where there is no oscillation that could pause.
    """
    found, intervals_s = _turns(trace, channel), _intervals_s(trace, channel)[1:]
    if not len(intervals_s):
        return 0.0
    last_s = float(trace.t_s[-1] - trace.t_s[found[-1].row])
    return max(last_s, float(np.max(intervals_s))) / float(np.median(intervals_s))


def yielding_share(trace: Trace, channel: ChannelName) -> float:
    """Share of the set-point's travel that leads away from the side of its mean on which the signal stands; 0 if it rests."""
    values, steps = measured(trace, channel), np.diff(set_point(trace, channel))
    travel = float(np.sum(np.abs(steps)))
    if np.ptp(values) == 0.0 or travel == 0.0:
        return 0.0
    away = steps * np.sign(values - np.mean(values))[:-1] < 0.0
    return float(np.sum(np.abs(steps[away]))) / travel
