"""Metrics of contact: spikes of force, contacts, and what is left of the deviation when contact is lost."""

import numpy as np

from hydrohil.claims.motion import max_deviation
from hydrohil.claims.signals import NAN, ChannelName, alternations, final_value, measured
from hydrohil.claims.trace import Integers, Reals, Trace, rows

NOISE_N = 10.0  # the gauge's noise is +-10 N (thesis 5.1.2)
CONTACT_N = 2.0 * NOISE_N  # above this a force is contact, whatever the noise
SPIKE = 1.2  # a force above the final level by a fifth is a spike
RINGING_S = 0.5  # the crate on the gauge rings at 4 Hz and dies in two periods


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
    """How often the tool comes into contact: the reading rises above 20 N after it was below zero.

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


def departure(trace: Trace, channel: ChannelName) -> float:
    """Largest distance of an axis from its nominal trajectory after the last contact; NaN without contact."""
    touching = np.flatnonzero(trace.force_n > CONTACT_N)
    if not len(touching) or touching[-1] == len(trace.t_s) - 1:
        return NAN
    return max_deviation(rows(trace, np.arange(len(trace.t_s)) > touching[-1]), channel)
