"""What a trace says of a link's gains: ripple, hunting, overshoot, error, break-away. Nothing here knows the plant."""

import math
from typing import NamedTuple

import numpy as np

from hydrohil.claims import tracking
from hydrohil.claims.motion import MOTION_COUNTS
from hydrohil.claims.signals import JOINTS, control, count_size, error, measured, rms, set_point, swings
from hydrohil.claims.trace import Trace, window
from hydrohil.shared.contract.messages import Mode
from hydrohil.thesis.claims4 import LARGE_SINE_S
from hydrohil.tuning.patterns import Pattern

TREND_DEGREE = 2  # what the rest of a first-order transient leaves; a ringing link swings several times
HUNTING_COUNTS = 2.0  # a link that turns round and goes further than this moves on its own account


def whole(trace: Trace, duration_s: float) -> bool:
    """Whether the trial ran to its end: nothing tripped and nothing is missing."""
    return bool(len(trace.t_s) > 1 and trace.mode[-1] == Mode.RUNNING and trace.t_s[-1] > 0.99 * duration_s)


class Ringing(NamedTuple):
    """Standard deviation of a link's error about its trend in the first and last third of a constant set speed, in counts.

    A link that follows perfectly shows the sawtooth of its encoder: 1 / sqrt(12) = 0.29 counts.
    """

    early: float
    late: float


def ringing(trace: Trace, link: int, setpoint: Pattern, least: float) -> Ringing:
    """Ringing of the constant speed in which it lasts longest; below `least` counts it is none."""
    found = [_ringing(window(trace, *cruise), link) for cruise in setpoint.cruises_s]
    return max(found, key=lambda ring: lasting(ring, least))


def lasting(ring: Ringing, least: float) -> float:
    """Late over early ripple, of which at least `least` counts: smaller for what dies away, 1 or more for what grows.

    A limit cycle that has reached its full size stays near 1.
    """
    return ring.late / max(ring.early, least)


def _ringing(part: Trace, link: int) -> Ringing:
    third_s = (part.t_s[-1] - part.t_s[0]) / 3.0
    early, late = window(part, part.t_s[0], part.t_s[0] + third_s), window(part, part.t_s[-1] - third_s, part.t_s[-1])
    return Ringing(_ripple_counts(early, link), _ripple_counts(late, link))


def _ripple_counts(part: Trace, link: int) -> float:
    wrong, t = error(part, JOINTS[link]), part.t_s - part.t_s[0]
    return float(np.std(wrong - np.polyval(np.polyfit(t, wrong, TREND_DEGREE), t))) / count_size(JOINTS[link])


def cruise_share(trace: Trace, link: int, setpoint: Pattern) -> float:
    """Speed of the link over that of its set-point while the latter is constant; the smallest."""
    return min(_speed_share(window(trace, *cruise), link) for cruise in setpoint.cruises_s)


def _speed_share(part: Trace, link: int) -> float:
    position, steps = measured(part, JOINTS[link]), set_point(part, JOINTS[link])
    return float((position[-1] - position[0]) / (steps[-1] - steps[0]))


def cruise_current_a(trace: Trace, link: int, setpoint: Pattern) -> float:
    """Mean valve current, without sign, that holds the constant speed."""
    currents = [abs(float(np.mean(control(window(trace, *cruise), JOINTS[link])))) for cruise in setpoint.cruises_s]
    return float(np.mean(currents))


def hunting(trace: Trace, link: int, setpoint: Pattern) -> int:
    """How often the link turns round while its set-point stands; the worse of both rests. A last correction counts as one."""
    least = HUNTING_COUNTS * count_size(JOINTS[link])
    return max(swings(measured(window(trace, *rest), JOINTS[link]), least) for rest in setpoint.rests_s)


def overshoot_q(trace: Trace, link: int, setpoint: Pattern) -> float:
    """How far the link goes beyond the end of its way there or back; the worse."""
    return max(tracking.overshoot(window(trace, *half), JOINTS[link]) for half in setpoint.halves_s)


def overshoot_counts(trace: Trace, link: int, setpoint: Pattern) -> float:
    """`overshoot_q` in encoder counts."""
    return overshoot_q(trace, link, setpoint) / count_size(JOINTS[link])


def rms_error_q(trace: Trace, link: int) -> float:
    """Root mean square of set-point minus measured over the whole trial."""
    return rms(error(trace, JOINTS[link]))


def large_swings(trace: Trace, link: int) -> float:
    """Peak to peak of the link over that of its set-point, mean over the sine's large cycles."""
    return tracking.cycle_ratio(window(trace, 0.0, LARGE_SINE_S), JOINTS[link])


def breakaway_a(trace: Trace, link: int) -> float:
    """Largest current up to the link's second encoder count; NaN if it never moves so far."""
    position, current = measured(trace, JOINTS[link]), np.abs(control(trace, JOINTS[link]))
    moved = np.flatnonzero(np.abs(position - position[0]) > MOTION_COUNTS * count_size(JOINTS[link]))
    return float(np.max(current[: moved[0] + 1])) if len(moved) else math.nan
