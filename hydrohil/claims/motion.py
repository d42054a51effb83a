"""What a signal does: levels, oscillation, delays, and how an axis departs from its nominal trajectory."""

import numpy as np

from hydrohil.claims.signals import (
    NAN,
    ChannelName,
    alternations,
    count_size,
    final_value,
    measured,
    moves,
    nominal,
    rms,
    set_point,
)
from hydrohil.claims.trace import Reals, Trace

MOTION_COUNTS = 1.5  # a link has moved at the second count: the first may be the edge of a step
SETTLED = 0.2  # a signal that stays within a fifth of its final value has settled


def mean(trace: Trace, channel: ChannelName) -> float:
    """Mean value."""
    return float(np.mean(measured(trace, channel)))


def maximum(trace: Trace, channel: ChannelName) -> float:
    """Largest value."""
    return float(np.max(measured(trace, channel)))


def minimum(trace: Trace, channel: ChannelName) -> float:
    """Smallest value."""
    return float(np.min(measured(trace, channel)))


def peak_to_peak(trace: Trace, channel: ChannelName) -> float:
    """Largest minus smallest value."""
    return float(np.ptp(measured(trace, channel)))


def peak_to_peak_counts(trace: Trace, channel: ChannelName) -> float:
    """Largest minus smallest position of a link, in encoder counts."""
    return peak_to_peak(trace, channel) / count_size(channel)


def final_change(trace: Trace, channel: ChannelName) -> float:
    """Mean over the window's last tenth minus its first value, with sign."""
    values = measured(trace, channel)
    return final_value(values) - float(values[0])


def period_s(trace: Trace, channel: ChannelName) -> float:
    """Period of an oscillation about the final value: twice the mean time between crossings.

    A swing counts if it goes beyond a tenth of the first one.
    """
    swing = measured(trace, channel) - final_value(measured(trace, channel))
    least = float(np.max(np.abs(swing))) / 10.0
    crossings = [_crossing_s(trace.t_s, swing, row) for row in alternations(swing, -least, least)]
    return 2.0 * (crossings[-1] - crossings[0]) / (len(crossings) - 1) if len(crossings) > 1 else NAN


def _crossing_s(t_s: Reals, values: Reals, row: int) -> float:
    """Time of the last change of sign at or before `row`, between samples."""
    before = int(np.flatnonzero(values[:row] * values[row] <= 0.0)[-1])
    share = values[before] / (values[before] - values[before + 1])
    return float(t_s[before] + share * (t_s[before + 1] - t_s[before]))


def settling_time_s(trace: Trace, channel: ChannelName) -> float:
    """From the window's start to the last time that the signal is off its final value by a fifth of it."""
    values = measured(trace, channel)
    final = final_value(values)
    off = np.flatnonzero(np.abs(values - final) > SETTLED * abs(final))
    return float(trace.t_s[off[-1]] - trace.t_s[0]) if len(off) else 0.0


def _delays_s(trace: Trace, link: ChannelName) -> list[float]:
    """From each start of the set-point's motion to the link's second count in that direction; at most to the next start."""
    position, delays = measured(trace, link), []
    for start, end, direction in moves(set_point(trace, link)):
        travelled = (position[start:end] - position[start]) * direction
        moved = np.flatnonzero(travelled > MOTION_COUNTS * count_size(link))
        row = start + int(moved[0]) if len(moved) else end - 1
        delays.append(float(trace.t_s[row] - trace.t_s[start]))
    return delays


def first_delay_s(trace: Trace, channel: ChannelName) -> float:
    """From the set-point's first motion to the link's."""
    delays = _delays_s(trace, channel)
    return delays[0] if delays else NAN


def longest_delay_s(trace: Trace, channel: ChannelName) -> float:
    """The longest of the delays after each start or reversal of the set-point."""
    return max(_delays_s(trace, channel), default=NAN)


def first_motion_s(trace: Trace, channel: ChannelName) -> float:
    """Time since tick 0 at which the link is two counts from where the window began."""
    position = measured(trace, channel)
    moved = np.flatnonzero(np.abs(position - position[0]) > MOTION_COUNTS * count_size(channel))
    return float(trace.t_s[moved[0]]) if len(moved) else NAN


def max_deviation(trace: Trace, channel: ChannelName) -> float:
    """Largest distance of an axis from its nominal trajectory."""
    return float(np.max(np.abs(measured(trace, channel) - nominal(trace, channel))))


def rms_deviation(trace: Trace, channel: ChannelName) -> float:
    """Root mean square distance of an axis from its nominal trajectory."""
    return rms(measured(trace, channel) - nominal(trace, channel))


def max_modification(trace: Trace, channel: ChannelName) -> float:
    """Largest distance of an axis' set-point from its nominal trajectory: how far the target impedance gave way."""
    return float(np.max(np.abs(set_point(trace, channel) - nominal(trace, channel))))


def mean_lag(trace: Trace, channel: ChannelName) -> float:
    """How far an axis stays behind its nominal trajectory on average, with sign."""
    return float(np.mean(nominal(trace, channel) - measured(trace, channel)))


def retreat(trace: Trace, channel: ChannelName) -> float:
    """Largest way back from the farthest point reached so far, for a motion in the positive direction."""
    values = measured(trace, channel)
    return float(np.max(np.maximum.accumulate(values) - values))
