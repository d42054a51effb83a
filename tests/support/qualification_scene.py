"""Figures of a host that keeps up at 222.2 Hz, to be made worse by one number at a time."""

from hydrohil.qualification.grading import Figures
from hydrohil.qualification.spread import Spread

PERIOD_NS = 4_500_000
FINE = Spread(100.0, 200.0, 300.0, 400.0)
GOOD = Figures(
    PERIOD_NS,
    wake_ups_us=FINE,
    wake_ups_shifting=0.0,
    wake_ups_skipping=0.0,
    limit_us=FINE,
    limit_by="cyclictest",
    ping_us=FINE,
    ping_lost=0.0,
    ended="",
    samples=4000,
    unanswered=0.0,
    shifts=0.0,
    lost=0.0,
    late_permits=0.0,
    worst_window=1.0,
    accepted_us=FINE,
    grid_us=FINE,
)


def worst(us: float) -> Spread:
    return FINE._replace(max=us)
