"""Step 5 of Appendix C: the valve current that overcomes stiction and deadband, in each direction.

Nobody can command a current. Under P control a slow set-point ramp raises it slowly, u = K_P e, until the link moves.
"""

import math
from typing import NamedTuple

import numpy as np

from services.controller.params import LinkGains
from shared.units import A_PER_MA
from tuning import measure
from tuning.bench import Bench, Step, play, rad_per_unit, unit
from tuning.patterns import pattern, slow_ramp

CURRENT_RATE_A_PER_S = 10.0 * A_PER_MA  # slow against the pressures, which the leak settles in tenths of a second
HIGHEST_A = 0.3  # at the end of the slow ramp: beyond it the link counts as stuck; full current is 360 mA
PLACES = (-0.25, 0.0, 0.25)  # of the large pattern, about its middle: volumes and weight differ along the travel
DIRECTIONS = (1, -1)  # down or out, up or in


class Breakaway(NamedTuple):
    """One slow ramp: where, which way, and the current at which the link broke loose, median of the seeds (NaN: it stuck)."""

    place_rad: float
    direction: int
    current_a: float


def breakaway(bench: Bench, gains: LinkGains, place_rad: float, direction: int) -> Breakaway:
    """Play slow ramps from one place in one direction."""
    speed = direction * CURRENT_RATE_A_PER_S / gains.kp_a_per_rad
    wanted = slow_ramp(bench.link, place_rad, speed, HIGHEST_A / CURRENT_RATE_A_PER_S)
    traces = play(bench, "pi", gains._replace(linear_ki_a_per_rad_s=0.0), wanted) or ()
    currents = [measure.breakaway_a(trace, bench.link) for trace in traces]
    return Breakaway(place_rad, direction, float(np.median(currents)) if currents else math.nan)


def threshold(tried: tuple[Breakaway, ...], direction: int) -> float:
    """Median of the places in one direction; NaN if the link stuck or tripped at any."""
    return float(np.median([one.current_a for one in tried if one.direction == direction]))


def stiction(bench: Bench, gains: LinkGains) -> Step:
    """Step 5: thresholds for VETIA; it fires below the same share of the weaker one as before."""
    size = pattern("large-ramp", bench.link, gains).size_rad
    tried = tuple(breakaway(bench, gains, share * size, way) for way in DIRECTIONS for share in PLACES)
    positive, negative = threshold(tried, 1), threshold(tried, -1)
    moved = math.isfinite(positive + negative)
    fires_below = gains.boost_below_a / min(gains.boost_positive_a, gains.boost_negative_a) if moved else 0.0
    decision = f"the link stuck or tripped before {HIGHEST_A / A_PER_MA:g} mA"
    if moved:
        decision = f"{positive / A_PER_MA:.3g} mA down or out, {negative / A_PER_MA:.3g} mA up or in"
    return Step(
        5,
        "threshold where the control overcomes stiction and deadband",
        f"P control, set-point so slow that the current rises by {CURRENT_RATE_A_PER_S / A_PER_MA:g} mA/s: "
        "largest current before the second encoder count; median of places",
        (f"place {unit(bench.link)}", "direction", "broke loose at, mA"),
        tuple((o.place_rad / rad_per_unit(bench.link), f"{o.direction:+d}", o.current_a / A_PER_MA) for o in tried),
        decision,
        gains._replace(
            boost_positive_a=positive,
            boost_negative_a=negative,
            boost_below_a=fires_below * min(positive, negative),
        )
        if moved
        else None,
    )
