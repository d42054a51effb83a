"""Joint velocities by linear regression over the last 20 encoder readings (thesis Appendix B).

v = sum (t - mean t) (q - q_newest) / sum (t - mean t)^2  with the samples' true times; it lags by half the window, 43 ms.
"""

from typing import NamedTuple

from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.machine.description import Triple
from hydrohil.shared.units import NS_PER_S

POINTS = 20  # Appendix B: smooth enough, and short enough to detect stiction quickly


class Point(NamedTuple):
    """Measured joint positions and set-points at one sample."""

    time_ns: int
    q: Triple
    q_set: Triple


Window = tuple[Point, ...]  # (20,), newest last


@kernel
def filled_window(time_ns: int, q: Triple, period_ns: int) -> Window:
    """A window that stood at `q` for 20 periods up to `time_ns`: velocity 0."""
    return (
        Point(time_ns - 19 * period_ns, q, q),
        Point(time_ns - 18 * period_ns, q, q),
        Point(time_ns - 17 * period_ns, q, q),
        Point(time_ns - 16 * period_ns, q, q),
        Point(time_ns - 15 * period_ns, q, q),
        Point(time_ns - 14 * period_ns, q, q),
        Point(time_ns - 13 * period_ns, q, q),
        Point(time_ns - 12 * period_ns, q, q),
        Point(time_ns - 11 * period_ns, q, q),
        Point(time_ns - 10 * period_ns, q, q),
        Point(time_ns - 9 * period_ns, q, q),
        Point(time_ns - 8 * period_ns, q, q),
        Point(time_ns - 7 * period_ns, q, q),
        Point(time_ns - 6 * period_ns, q, q),
        Point(time_ns - 5 * period_ns, q, q),
        Point(time_ns - 4 * period_ns, q, q),
        Point(time_ns - 3 * period_ns, q, q),
        Point(time_ns - 2 * period_ns, q, q),
        Point(time_ns - period_ns, q, q),
        Point(time_ns, q, q),
    )


@kernel
def push(window: Window, time_ns: int, q: Triple, q_set: Triple) -> Window:
    """The window with its oldest point replaced by a new one."""
    return window[1:] + (Point(time_ns, q, q_set),)  # numba has no starred tuple


@kernel
def velocities(window: Window) -> tuple[Triple, Triple]:
    """Least-squares slopes (rad/s, m/s) of measured positions and set-points; 0 if all times are one.

    Times and positions are taken relative to the newest, so that a link at rest has velocity 0 exactly.
    """
    newest = window[POINTS - 1]
    newest_ns = newest.time_ns
    p1, p2, p3 = newest.q
    r1, r2, r3 = newest.q_set
    sum_ns = 0
    for point in window:
        sum_ns += point.time_ns - newest_ns
    mean_s = sum_ns / (POINTS * NS_PER_S)
    square, v1, v2, v3, w1, w2, w3 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for time_ns, q, q_set in window:
        t = (time_ns - newest_ns) / NS_PER_S - mean_s
        square += t * t
        v1 += t * (q[0] - p1)
        v2 += t * (q[1] - p2)
        v3 += t * (q[2] - p3)
        w1 += t * (q_set[0] - r1)
        w2 += t * (q_set[1] - r2)
        w3 += t * (q_set[2] - r3)
    if square <= 0.0:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    return (v1 / square, v2 / square, v3 / square), (w1 / square, w2 / square, w3 / square)
