"""The closed set of numbers that a claim can be about: each a pure function of a window of a trace.

Every metric takes the rows of the claim's window and a channel, and returns SI (rad, m, N, A, s, or a plain number).
NaN says that the window does not determine it; a claim about NaN fails.
"""

from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from experiments.signals import (
    AXES,
    CHANNELS,
    LINKS,
    ChannelName,
    alternations,
    control,
    count_size,
    error,
    final_value,
    measured,
    moves,
    nominal,
    rms,
    set_point,
    swings,
)
from experiments.trace import Integers, Reals, Trace, rows
from shared.units import A_PER_MA

NAN = float("nan")
MOTION_COUNTS = 1.5  # a link has moved at the second count: the first may be the edge of a step
OVERLAP_A = 36.0 * A_PER_MA  # 6 % deadband of a 600 mA valve (thesis 4.2): below it a current moves nothing
NOISE_N = 10.0  # the gauge's noise is +-10 N (thesis 5.1.2)
CONTACT_N = 2.0 * NOISE_N  # above this a force is contact, whatever the noise
HIGH_FORCE_N = 200.0  # "contact forces exceeded 200 N" (thesis 5.7)
SETTLED = 0.2  # a signal that stays within a fifth of its final value has settled
SPIKE = 1.2  # a force above the final level by a fifth is a spike
RINGING_S = 0.5  # the crate on the gauge rings at 4 Hz and dies in two periods


def rms_error(trace: Trace, channel: ChannelName) -> float:
    """Root mean square of set-point minus measured."""
    return rms(error(trace, channel))


def max_error(trace: Trace, channel: ChannelName) -> float:
    """Largest absolute error."""
    return float(np.max(np.abs(error(trace, channel))))


def relative_error(trace: Trace, channel: ChannelName) -> float:
    """rms error over the rms of the set-point about its mean: standing still gives 1."""
    wanted = set_point(trace, channel)
    scale = rms(wanted - np.mean(wanted))
    return rms_error(trace, channel) / scale if scale > 0.0 else NAN


def steady_error(trace: Trace, channel: ChannelName) -> float:
    """Mean error over mean set-point, without sign."""
    wanted = float(np.mean(set_point(trace, channel)))
    return abs(float(np.mean(error(trace, channel))) / wanted) if wanted != 0.0 else NAN


def steady_error_counts(trace: Trace, channel: ChannelName) -> float:
    """Mean error of a link in widths of its encoder's count, without sign."""
    return abs(float(np.mean(error(trace, channel)))) / count_size(channel)


def overshoot(trace: Trace, channel: ChannelName) -> float:
    """How far the signal goes beyond the set-point's final value, in the direction in which the set-point went."""
    wanted = set_point(trace, channel)
    direction = np.sign(wanted[-1] - wanted[0])
    return float(np.max((measured(trace, channel) - wanted[-1]) * direction)) if direction != 0.0 else NAN


def peak_to_peak(trace: Trace, channel: ChannelName) -> float:
    """Largest minus smallest value."""
    return float(np.ptp(measured(trace, channel)))


def peak_to_peak_counts(trace: Trace, channel: ChannelName) -> float:
    """Largest minus smallest position of a link, in encoder counts."""
    return peak_to_peak(trace, channel) / count_size(channel)


def peak_to_peak_ratio(trace: Trace, channel: ChannelName) -> float:
    """Peak to peak of the signal over that of its set-point."""
    wanted = float(np.ptp(set_point(trace, channel)))
    return peak_to_peak(trace, channel) / wanted if wanted > 0.0 else NAN


def cycle_ratio(trace: Trace, channel: ChannelName) -> float:
    """Peak to peak of the signal over that of its set-point, mean over the set-point's full cycles.

    A cycle runs from one turning point of the set-point to the next but one.
    """
    wanted, seen = set_point(trace, channel), measured(trace, channel)
    turns = [start for start, _, _ in moves(wanted)][1:]
    cycles = [slice(start, end + 1) for start, end in zip(turns[:-2:2], turns[2::2], strict=True)]
    ratios = [np.ptp(seen[cycle]) / np.ptp(wanted[cycle]) for cycle in cycles]
    return float(np.mean(ratios)) if ratios else NAN


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


def error_rate_to_error(trace: Trace, channel: ChannelName) -> float:
    """Largest velocity error over largest position error of a link, in 1/s."""
    link = LINKS.index(channel)
    rate = np.max(np.abs(trace.qd_set_rad_per_s[:, link] - trace.qd_rad_per_s[:, link]))
    largest = max_error(trace, channel)
    return float(rate) / largest if largest > 0.0 else NAN


def error_integral_to_error(trace: Trace, channel: ChannelName) -> float:
    """Largest time integral of the error over the largest error, in s."""
    wrong, largest = error(trace, channel), max_error(trace, channel)
    integral = np.cumsum((wrong[1:] + wrong[:-1]) / 2.0 * np.diff(trace.t_s))
    return float(np.max(np.abs(integral))) / largest if largest > 0.0 and len(integral) else NAN


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


def mean(trace: Trace, channel: ChannelName) -> float:
    """Mean value."""
    return float(np.mean(measured(trace, channel)))


def maximum(trace: Trace, channel: ChannelName) -> float:
    """Largest value."""
    return float(np.max(measured(trace, channel)))


def minimum(trace: Trace, channel: ChannelName) -> float:
    """Smallest value."""
    return float(np.min(measured(trace, channel)))


def max_deviation(trace: Trace, channel: ChannelName) -> float:
    """Largest distance of an axis from its nominal trajectory."""
    return float(np.max(np.abs(measured(trace, channel) - nominal(trace, channel))))


def max_modification(trace: Trace, channel: ChannelName) -> float:
    """Largest distance of an axis' set-point from its nominal trajectory: what the target impedance made of the forces."""
    return float(np.max(np.abs(set_point(trace, channel) - nominal(trace, channel))))


def departure(trace: Trace, channel: ChannelName) -> float:
    """Largest distance of an axis from its nominal trajectory after the last contact; NaN without contact."""
    touching = np.flatnonzero(trace.force_n > CONTACT_N)
    if not len(touching) or touching[-1] == len(trace.t_s) - 1:
        return NAN
    return max_deviation(rows(trace, np.arange(len(trace.t_s)) > touching[-1]), channel)


def mean_lag(trace: Trace, channel: ChannelName) -> float:
    """How far an axis stays behind its nominal trajectory on average, with sign."""
    return float(np.mean(nominal(trace, channel) - measured(trace, channel)))


def retreat(trace: Trace, channel: ChannelName) -> float:
    """Largest way back from the farthest point reached so far, for a motion in the positive direction."""
    values = measured(trace, channel)
    return float(np.max(np.maximum.accumulate(values) - values))


def spikes(trace: Trace, channel: ChannelName) -> float:
    """How often the force rises above its final level by a fifth, having been below that level.

    What rises within half a second of a spike is its ringing and belongs to it.
    """
    force_n = measured(trace, channel)
    level = final_value(force_n)
    if level <= CONTACT_N:
        return NAN
    count, last_s = 0, -RINGING_S
    for at_s in trace.t_s[_rises(force_n, level, SPIKE * level)].tolist():
        if at_s - last_s >= RINGING_S:
            count, last_s = count + 1, at_s
    return float(count)


def contacts(trace: Trace, channel: ChannelName) -> float:
    """How often contact is made: the reading rises above 20 N after it was below zero.

    With +-10 N of noise the first needs a true force above 10 N and the second one below.
    """
    return float(len(_rises(measured(trace, channel), 0.0, CONTACT_N)))


def _rises(values: Reals, low: float, high: float) -> Integers:
    """(m,) rows at which `values` comes above `high` for the first time, or after having been below `low`."""
    turns = alternations(values, low, high)
    outside = np.flatnonzero((values > high) | (values < low))
    first = outside[:1]
    both = np.concatenate((first, turns))
    return np.asarray(both[values[both] > high], dtype=np.int64)


def control_reversals(trace: Trace, channel: ChannelName) -> float:
    """How often the valve current goes from one side of the spool's overlap (36 mA) to the other."""
    return float(len(alternations(control(trace, channel), -OVERLAP_A, OVERLAP_A)))


def control_swings(trace: Trace, channel: ChannelName) -> float:
    """How often the valve current turns round and goes further than the spool's overlap (36 mA) the other way."""
    return float(swings(control(trace, channel), OVERLAP_A))


def control_rms(trace: Trace, channel: ChannelName) -> float:
    """Root mean square of a link's valve current."""
    return rms(control(trace, channel))


def control_peak(trace: Trace, channel: ChannelName) -> float:
    """Largest absolute valve current of a link."""
    return float(np.max(np.abs(control(trace, channel))))


def braking_control_ratio(trace: Trace, channel: ChannelName) -> float:
    """rms valve current while the set-point of a link slows down over that while it speeds up."""
    speed = trace.qd_set_rad_per_s[:, LINKS.index(channel)]
    power, current = speed * np.gradient(speed, trace.t_s), control(trace, channel)
    braking, driving = current[power < 0.0], current[power > 0.0]
    return rms(braking) / rms(driving) if len(braking) and len(driving) and rms(driving) > 0.0 else NAN


def upward_error_ratio(trace: Trace, channel: ChannelName) -> float:
    """rms force error while a force above 200 N is being lowered, the tool rising, over that while it is being raised."""
    change = np.gradient(trace.force_set_n, trace.t_s)
    high = trace.force_set_n > HIGH_FORCE_N
    rising, sinking = rows(trace, high & (change < 0.0)), rows(trace, high & (change > 0.0))
    if not (len(rising.t_s) and len(sinking.t_s)) or rms_error(sinking, channel) == 0.0:
        return NAN
    return rms_error(rising, channel) / rms_error(sinking, channel)


MetricName = Literal[
    "rms_error",
    "max_error",
    "relative_error",
    "steady_error",
    "steady_error_counts",
    "overshoot",
    "peak_to_peak",
    "peak_to_peak_counts",
    "peak_to_peak_ratio",
    "cycle_ratio",
    "first_delay_s",
    "longest_delay_s",
    "first_motion_s",
    "error_rate_to_error",
    "error_integral_to_error",
    "final_change",
    "period_s",
    "settling_time_s",
    "mean",
    "maximum",
    "minimum",
    "max_deviation",
    "max_modification",
    "departure",
    "mean_lag",
    "retreat",
    "spikes",
    "contacts",
    "control_reversals",
    "control_swings",
    "control_rms",
    "control_peak",
    "braking_control_ratio",
    "upward_error_ratio",
]
Dimension = Literal["channel", "angle", "length", "force", "time", "current", "number", "rate"]


class Metric(NamedTuple):
    """A function of a window, what it measures in, and the channels it is defined on."""

    of: Callable[[Trace, ChannelName], float]
    dimension: Dimension  # "channel": whatever the channel is in
    channels: tuple[ChannelName, ...]


_FORCE: tuple[ChannelName, ...] = ("force",)
METRICS: dict[MetricName, Metric] = {
    "rms_error": Metric(rms_error, "channel", CHANNELS),
    "max_error": Metric(max_error, "channel", CHANNELS),
    "relative_error": Metric(relative_error, "number", CHANNELS),
    "steady_error": Metric(steady_error, "number", CHANNELS),
    "steady_error_counts": Metric(steady_error_counts, "number", LINKS),
    "overshoot": Metric(overshoot, "channel", CHANNELS),
    "peak_to_peak": Metric(peak_to_peak, "channel", CHANNELS),
    "peak_to_peak_counts": Metric(peak_to_peak_counts, "number", LINKS),
    "peak_to_peak_ratio": Metric(peak_to_peak_ratio, "number", CHANNELS),
    "cycle_ratio": Metric(cycle_ratio, "number", CHANNELS),
    "first_delay_s": Metric(first_delay_s, "time", LINKS),
    "longest_delay_s": Metric(longest_delay_s, "time", LINKS),
    "first_motion_s": Metric(first_motion_s, "time", LINKS),
    "error_rate_to_error": Metric(error_rate_to_error, "rate", LINKS),
    "error_integral_to_error": Metric(error_integral_to_error, "time", CHANNELS),
    "final_change": Metric(final_change, "channel", CHANNELS),
    "period_s": Metric(period_s, "time", CHANNELS),
    "settling_time_s": Metric(settling_time_s, "time", CHANNELS),
    "mean": Metric(mean, "channel", CHANNELS),
    "maximum": Metric(maximum, "channel", CHANNELS),
    "minimum": Metric(minimum, "channel", CHANNELS),
    "max_deviation": Metric(max_deviation, "length", AXES),
    "max_modification": Metric(max_modification, "length", AXES),
    "departure": Metric(departure, "length", AXES),
    "mean_lag": Metric(mean_lag, "length", AXES),
    "retreat": Metric(retreat, "channel", CHANNELS),
    "spikes": Metric(spikes, "number", _FORCE),
    "contacts": Metric(contacts, "number", _FORCE),
    "control_reversals": Metric(control_reversals, "number", LINKS),
    "control_swings": Metric(control_swings, "number", LINKS),
    "control_rms": Metric(control_rms, "current", LINKS),
    "control_peak": Metric(control_peak, "current", LINKS),
    "braking_control_ratio": Metric(braking_control_ratio, "number", LINKS),
    "upward_error_ratio": Metric(upward_error_ratio, "number", _FORCE),
}
