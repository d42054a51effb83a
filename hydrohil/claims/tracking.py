"""How well a signal follows its set-point."""

import numpy as np

from hydrohil.claims.signals import JOINTS, NAN, ChannelName, count_size, error, measured, moves, rms, set_point
from hydrohil.claims.trace import Trace, rows

HIGH_FORCE_N = 200.0  # "contact forces exceeded 200 N" (thesis 5.7)


def rms_error(trace: Trace, channel: ChannelName) -> float:
    """Root mean square of set-point minus measured."""
    return rms(error(trace, channel))


def max_error(trace: Trace, channel: ChannelName) -> float:
    """Largest absolute error."""
    return float(np.max(np.abs(error(trace, channel))))


def relative_error(trace: Trace, channel: ChannelName) -> float:
    """rms error over the rms of the set-point about its mean: standing still gives 1."""
    setpoint = set_point(trace, channel)
    scale = rms(setpoint - np.mean(setpoint))
    return rms_error(trace, channel) / scale if scale > 0.0 else NAN


def steady_error(trace: Trace, channel: ChannelName) -> float:
    """Mean error over mean set-point, without sign."""
    setpoint = float(np.mean(set_point(trace, channel)))
    return abs(float(np.mean(error(trace, channel))) / setpoint) if setpoint != 0.0 else NAN


def steady_error_counts(trace: Trace, channel: ChannelName) -> float:
    """Mean error of a link in widths of its encoder's count, without sign."""
    return abs(float(np.mean(error(trace, channel)))) / count_size(channel)


def overshoot(trace: Trace, channel: ChannelName) -> float:
    """How far the signal goes beyond the set-point's final value, in the direction in which the set-point went."""
    setpoint = set_point(trace, channel)
    direction = np.sign(setpoint[-1] - setpoint[0])
    return float(np.max((measured(trace, channel) - setpoint[-1]) * direction)) if direction != 0.0 else NAN


def peak_to_peak_ratio(trace: Trace, channel: ChannelName) -> float:
    """Peak to peak of the signal over that of its set-point."""
    setpoint = float(np.ptp(set_point(trace, channel)))
    return float(np.ptp(measured(trace, channel))) / setpoint if setpoint > 0.0 else NAN


def cycle_ratio(trace: Trace, channel: ChannelName) -> float:
    """Peak to peak of the signal over that of its set-point, mean over the set-point's full cycles.

    A cycle runs from one turning point of the set-point to the next but one.
    """
    setpoint, values = set_point(trace, channel), measured(trace, channel)
    turns = [start for start, _, _ in moves(setpoint)][1:]
    cycles = [slice(start, end + 1) for start, end in zip(turns[:-2:2], turns[2::2], strict=True)]
    ratios = [np.ptp(values[cycle]) / np.ptp(setpoint[cycle]) for cycle in cycles]
    return float(np.mean(ratios)) if ratios else NAN


def error_rate_to_error(trace: Trace, channel: ChannelName) -> float:
    """Largest velocity error over largest position error of a link, in 1/s."""
    link = JOINTS.index(channel)
    rate = np.max(np.abs(trace.qd_set[:, link] - trace.qd[:, link]))
    largest = max_error(trace, channel)
    return float(rate) / largest if largest > 0.0 else NAN


def error_integral_to_error(trace: Trace, channel: ChannelName) -> float:
    """Largest time integral of the error over the largest error, in s."""
    wrong, largest = error(trace, channel), max_error(trace, channel)
    integral = np.cumsum((wrong[1:] + wrong[:-1]) / 2.0 * np.diff(trace.t_s))
    return float(np.max(np.abs(integral))) / largest if largest > 0.0 and len(integral) else NAN


def upward_error_ratio(trace: Trace, channel: ChannelName) -> float:
    """rms force error while a force above 200 N is being lowered, the tool rising, over that while it is being raised."""
    change = np.gradient(trace.force_set_n, trace.t_s)
    high = trace.force_set_n > HIGH_FORCE_N
    rising, sinking = rows(trace, high & (change < 0.0)), rows(trace, high & (change > 0.0))
    if not (len(rising.t_s) and len(sinking.t_s)) or rms_error(sinking, channel) == 0.0:
        return NAN
    return rms_error(rising, channel) / rms_error(sinking, channel)
