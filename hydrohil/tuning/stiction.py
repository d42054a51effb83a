"""Step 5 of Appendix C: the valve current that overcomes stiction and deadband, in each direction.

The procedure cannot command a current. Under P control a slow set-point ramp raises it slowly, u = K_P e, until the link moves.
"""

import math
from typing import NamedTuple

import numpy as np

from hydrohil.experiment.sections import LinkGains
from hydrohil.shared.units import A_PER_MA
from hydrohil.tuning import measure
from hydrohil.tuning.bench import Bench, Step, play, rad_per_unit, unit
from hydrohil.tuning.patterns import pattern, slow_ramp

SLOW_A_PER_S = 10.0 * A_PER_MA  # slow against the pressures, which the leak settles in tenths of a second
FAST_A_PER_S = 50.0 * A_PER_MA  # for the evidence: what a faster current adds before the pressures have followed
HIGHEST_A = 0.3  # at the end of the slow ramp: beyond it the link counts as stuck; full current is 360 mA
PLACES = (-0.25, 0.0, 0.25)  # of the large pattern, about its middle: volumes and weight differ along the travel
DIRECTIONS = (1, -1)  # down or out, up or in


class Breakaway(NamedTuple):
    """One creeping set-point: the current at which the link broke loose, median of the seeds (NaN: it stuck)."""

    place_q: float
    rate_a_per_s: float
    direction: int
    current_a: float


def breakaway(bench: Bench, gains: LinkGains, place_q: float, rate_a_per_s: float, direction: int) -> Breakaway:
    """Play a creeping set-point from one place in one direction."""
    speed = direction * rate_a_per_s / gains.kp_a_per_q
    setpoint = slow_ramp(bench.link, place_q, speed, HIGHEST_A / rate_a_per_s)
    traces = play(bench, "pi", gains._replace(linear_ki_a_per_q_s=0.0), setpoint) or ()
    currents = [measure.breakaway_a(trace, bench.link) for trace in traces]
    return Breakaway(place_q, rate_a_per_s, direction, float(np.median(currents)) if currents else math.nan)


def threshold(tried: tuple[Breakaway, ...], direction: int) -> float:
    """Median of the places in one direction, the current rising slowly; NaN if the link stuck or tripped at any."""
    slow = [one.current_a for one in tried if one.direction == direction and one.rate_a_per_s == SLOW_A_PER_S]
    return float(np.median(slow))


def stiction(bench: Bench, gains: LinkGains) -> Step:
    """Step 5: thresholds for VETIA, which fires below the same share of the weaker one as before."""
    size = pattern("large-ramp", bench.link, gains).size_q
    tried = tuple(breakaway(bench, gains, share * size, SLOW_A_PER_S, direction) for direction in DIRECTIONS for share in PLACES)
    tried += tuple(breakaway(bench, gains, 0.0, FAST_A_PER_S, direction) for direction in DIRECTIONS)
    return stiction_step(bench, gains, tried)


def stiction_step(bench: Bench, gains: LinkGains, tried: tuple[Breakaway, ...]) -> Step:
    """What step 5 makes of the currents measured."""
    positive, negative = threshold(tried, 1), threshold(tried, -1)
    decision, tuned = f"the link stuck or tripped before {HIGHEST_A / A_PER_MA:g} mA", None
    if math.isfinite(positive + negative):
        decision = f"{positive / A_PER_MA:.3g} mA down or out, {negative / A_PER_MA:.3g} mA up or in"
        weaker = min(gains.boost_positive_a, gains.boost_negative_a)
        share = gains.boost_below_a / weaker if weaker > 0.0 else 1.0
        tuned = gains._replace(
            boost_positive_a=positive, boost_negative_a=negative, boost_below_a=share * min(positive, negative)
        )
    return Step(
        number=5,
        title="threshold where the control overcomes stiction and deadband",
        rule=f"P control, set-point so slow that the current rises by {SLOW_A_PER_S / A_PER_MA:g} mA/s: "
        "largest current before the second encoder count; median of places",
        columns=(f"place {unit(bench.link)}", "current rises, mA/s", "direction", "broke loose at, mA"),
        rows=tuple(
            (o.place_q / rad_per_unit(bench.link), o.rate_a_per_s / A_PER_MA, f"{o.direction:+d}", o.current_a / A_PER_MA)
            for o in tried
        ),
        decision=decision,
        gains=tuned,
    )
