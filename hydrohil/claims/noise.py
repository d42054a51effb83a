"""How much of the gauge's noise reaches the set-point."""

import numpy as np

from hydrohil.claims.signals import NAN, ChannelName, nominal, rms, set_point
from hydrohil.claims.trace import Trace

FAST_S = 0.5  # target dynamics are "no frequencies greater than 1Hz" (thesis 5.1.4); what is faster than that is noise


def setpoint_noise(trace: Trace, channel: ChannelName) -> float:
    """rms of the fast part of what the target impedance adds to an axis: x_s - x_d about its mean over half a second."""
    added = set_point(trace, channel) - nominal(trace, channel)
    width = round(FAST_S / float(np.median(np.diff(trace.t_s)))) // 2 * 2 + 1 if len(added) > 1 else 1
    if not 1 < width < len(added):
        return NAN
    slow = np.convolve(added, np.full(width, 1.0 / width), mode="valid")
    return rms(added[width // 2 : -(width // 2)] - slow)
