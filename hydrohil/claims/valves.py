"""What the law asks of the valves."""

import numpy as np

from hydrohil.claims.signals import JOINTS, NAN, ChannelName, alternations, control, moves, rms, swings
from hydrohil.claims.trace import Trace
from hydrohil.shared.units import A_PER_MA

OVERLAP_A = 36.0 * A_PER_MA  # 6 % deadband of a 600 mA valve (thesis 4.2): below it a current moves nothing


def control_reversals(trace: Trace, channel: ChannelName) -> float:
    """How often the valve current goes from one side of the spool's overlap (36 mA) to the other."""
    return float(len(alternations(control(trace, channel), -OVERLAP_A, OVERLAP_A)))


def control_swings(trace: Trace, channel: ChannelName) -> float:
    """How often the valve current turns round and goes further than the spool's overlap (36 mA) the other way."""
    return float(swings(control(trace, channel), OVERLAP_A))


def upward_swing_ratio(trace: Trace, channel: ChannelName) -> float:
    """Swings of the control while the force is being lowered, the tool rising, over those while it is being raised."""
    current, raised, lowered = control(trace, channel), 0, 0
    for start, end, direction in moves(trace.force_set_n):
        count = swings(current[start:end], OVERLAP_A)
        raised, lowered = (raised + count, lowered) if direction > 0.0 else (raised, lowered + count)
    return lowered / raised if raised else NAN


def control_rms(trace: Trace, channel: ChannelName) -> float:
    """Root mean square of a link's valve current."""
    return rms(control(trace, channel))


def control_peak(trace: Trace, channel: ChannelName) -> float:
    """Largest absolute valve current of a link."""
    return float(np.max(np.abs(control(trace, channel))))


def control_noise(trace: Trace, channel: ChannelName) -> float:
    """Root mean square change of a link's valve current from one sample to the next."""
    return rms(np.diff(control(trace, channel)))


def braking_control_ratio(trace: Trace, channel: ChannelName) -> float:
    """rms valve current while the set-point of a link slows down over that while it speeds up."""
    speed = trace.qd_set[:, JOINTS.index(channel)]
    power, current = speed * np.gradient(speed, trace.t_s), control(trace, channel)
    braking, driving = current[power < 0.0], current[power > 0.0]
    return rms(braking) / rms(driving) if len(braking) and len(driving) and rms(driving) > 0.0 else NAN
