"""The closed set of numbers that a claim can be about: each a pure function of a window of a trace.

Every metric takes the rows of the claim's window and a channel, and returns SI (rad, m, N, A, s, or a plain number).
NaN says that the window does not determine it; a claim about NaN fails.
"""

from collections.abc import Callable
from typing import Literal, NamedTuple

from hydrohil.claims.contact import contacts, departure, spikes
from hydrohil.claims.cycles import cycle_amplitude, cycle_onset_s, cycle_period_s, cycles, pause_ratio, yielding_share
from hydrohil.claims.motion import (
    final_change,
    first_delay_s,
    first_motion_s,
    longest_delay_s,
    max_deviation,
    max_modification,
    maximum,
    mean,
    mean_lag,
    minimum,
    peak_to_peak,
    peak_to_peak_counts,
    period_s,
    retreat,
    rms_deviation,
    settling_time_s,
)
from hydrohil.claims.noise import setpoint_noise
from hydrohil.claims.signals import AXES, CHANNELS, JOINTS, ChannelName
from hydrohil.claims.trace import Trace
from hydrohil.claims.tracking import (
    cycle_ratio,
    error_integral_to_error,
    error_rate_to_error,
    max_error,
    overshoot,
    peak_to_peak_ratio,
    relative_error,
    rms_error,
    steady_error,
    steady_error_counts,
    upward_error_ratio,
)
from hydrohil.claims.valves import (
    braking_control_ratio,
    control_noise,
    control_peak,
    control_reversals,
    control_rms,
    control_swings,
    upward_swing_ratio,
)

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
    "rms_deviation",
    "setpoint_noise",
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
    "control_noise",
    "braking_control_ratio",
    "upward_error_ratio",
    "upward_swing_ratio",
    "cycles",
    "cycle_amplitude",
    "cycle_period_s",
    "cycle_onset_s",
    "pause_ratio",
    "yielding_share",
]
Dimension = Literal["channel", "angle", "length", "force", "time", "current", "number", "rate", "stiffness", "speed"]


class Metric(NamedTuple):
    """A function of a window, what it measures in, and the channels it is defined on."""

    of: Callable[[Trace, ChannelName], float]
    dimension: Dimension  # "channel": whatever the channel is in
    channels: tuple[ChannelName, ...]


_FORCE: tuple[ChannelName, ...] = ("force",)
_POSITIONS: tuple[ChannelName, ...] = (*JOINTS, *AXES)
METRICS: dict[MetricName, Metric] = {
    "rms_error": Metric(rms_error, "channel", CHANNELS),
    "max_error": Metric(max_error, "channel", CHANNELS),
    "relative_error": Metric(relative_error, "number", CHANNELS),
    "steady_error": Metric(steady_error, "number", CHANNELS),
    "steady_error_counts": Metric(steady_error_counts, "number", JOINTS),
    "overshoot": Metric(overshoot, "channel", CHANNELS),
    "peak_to_peak": Metric(peak_to_peak, "channel", CHANNELS),
    "peak_to_peak_counts": Metric(peak_to_peak_counts, "number", JOINTS),
    "peak_to_peak_ratio": Metric(peak_to_peak_ratio, "number", CHANNELS),
    "cycle_ratio": Metric(cycle_ratio, "number", CHANNELS),
    "first_delay_s": Metric(first_delay_s, "time", JOINTS),
    "longest_delay_s": Metric(longest_delay_s, "time", JOINTS),
    "first_motion_s": Metric(first_motion_s, "time", JOINTS),
    "error_rate_to_error": Metric(error_rate_to_error, "rate", JOINTS),
    "error_integral_to_error": Metric(error_integral_to_error, "time", CHANNELS),
    "final_change": Metric(final_change, "channel", CHANNELS),
    "period_s": Metric(period_s, "time", CHANNELS),
    "settling_time_s": Metric(settling_time_s, "time", CHANNELS),
    "mean": Metric(mean, "channel", CHANNELS),
    "maximum": Metric(maximum, "channel", CHANNELS),
    "minimum": Metric(minimum, "channel", CHANNELS),
    "max_deviation": Metric(max_deviation, "length", AXES),
    "rms_deviation": Metric(rms_deviation, "length", AXES),
    "setpoint_noise": Metric(setpoint_noise, "length", AXES),
    "max_modification": Metric(max_modification, "length", AXES),
    "departure": Metric(departure, "length", AXES),
    "mean_lag": Metric(mean_lag, "length", AXES),
    "retreat": Metric(retreat, "channel", CHANNELS),
    "spikes": Metric(spikes, "number", _FORCE),
    "contacts": Metric(contacts, "number", _FORCE),
    "control_reversals": Metric(control_reversals, "number", JOINTS),
    "control_swings": Metric(control_swings, "number", JOINTS),
    "control_rms": Metric(control_rms, "current", JOINTS),
    "control_peak": Metric(control_peak, "current", JOINTS),
    "control_noise": Metric(control_noise, "current", JOINTS),
    "braking_control_ratio": Metric(braking_control_ratio, "number", JOINTS),
    "upward_error_ratio": Metric(upward_error_ratio, "number", _FORCE),
    "upward_swing_ratio": Metric(upward_swing_ratio, "number", JOINTS),
    "cycles": Metric(cycles, "number", _POSITIONS),
    "cycle_amplitude": Metric(cycle_amplitude, "channel", _POSITIONS),
    "cycle_period_s": Metric(cycle_period_s, "time", _POSITIONS),
    "cycle_onset_s": Metric(cycle_onset_s, "time", _POSITIONS),
    "pause_ratio": Metric(pause_ratio, "number", _POSITIONS),
    "yielding_share": Metric(yielding_share, "number", _POSITIONS),
}
