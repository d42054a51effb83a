"""Steps 3 and 4 of Appendix C: optimum alpha and K_I of the modified Morse law on the fastest ramp."""

import math
from typing import NamedTuple

import numpy as np

from hydrohil.claims.trace import Trace
from hydrohil.experiment.sections import LinkGains
from hydrohil.tuning import measure
from hydrohil.tuning.bench import Bench, Criteria, Step, a_per_printed, play, rad_per_unit, rings_on, unit, worst_ringing, yes
from hydrohil.tuning.measure import Ringing
from hydrohil.tuning.patterns import Pattern, pattern
from hydrohil.tuning.search import Found, Tried, largest

FACTOR = math.sqrt(2.0)
WIDEST = 1024.0
ALPHAS = tuple(2.0**power for power in range(11))  # alpha_max over the fastest set speed squared: to a factor of 2


class Tuned(NamedTuple):
    """What steps 3 and 4 end with; no gains where every K_I, or every alpha, fails."""

    integral: Found
    with_integral: LinkGains | None
    alphas: tuple[Tried, ...]
    gains: LinkGains | None


def judge_integral(bench: Bench, gains: LinkGains, value: float) -> Tried:
    """Error and ringing of the fastest ramp; turns at rest, overshoot of the small step, large swings of the sine; worst seed."""
    link, criteria, tried = bench.link, bench.criteria, gains._replace(ki_a_per_q_s=value)
    ramp, step, small, sine = (pattern(name, link, gains) for name in ("large-ramp", "small-step", "small-ramp", "sine"))
    ramped, stepped, crept, waved = (play(bench, "morse", tried, setpoint) for setpoint in (ramp, step, small, sine))
    if ramped is None or stepped is None or crept is None or waved is None:
        return Tried(value, False, (math.inf,) * 6)
    ring = worst_ringing(bench, ramped, ramp)
    rests: tuple[tuple[Pattern, tuple[Trace, ...]], ...] = ((ramp, ramped), (step, stepped), (small, crept))
    turns = max(measure.hunting(trace, link, setpoint) for setpoint, traces in rests for trace in traces)
    overshoot = max(measure.overshoot_counts(trace, link, step) for trace in stepped)
    swing = max(measure.large_swings(trace, link) for trace in waved)
    error = float(np.median([measure.rms_error_q(trace, link) for trace in ramped]))
    numbers = (error, *ring, float(turns), overshoot, swing)
    return Tried(value, not suffers(criteria, numbers), numbers)


def suffers(criteria: Criteria, numbers: tuple[float, ...]) -> str:
    """What a pattern shows that rules the gain out, as a phrase; "" if nothing does."""
    _, early, late, turns, overshoot, swing = numbers
    if not math.isfinite(swing):
        return "a trial trips"
    if rings_on(criteria, Ringing(early, late)):
        return "the fastest ramp rings on"
    if turns > criteria.hunting:
        return f"the link hunts at rest ({turns:.0f} turns)"
    if overshoot > criteria.overshoot_counts:
        return f"the small step overshoots by {overshoot:.1f} counts"
    return f"the sine's large swings overshoot by {swing - 1.0:.1%}" if swing > criteria.swing_ratio else ""


def judge_alpha(bench: Bench, gains: LinkGains, alpha: float) -> Tried:
    """What `judge_integral` measures, at `alpha`."""
    return judge_integral(bench, gains._replace(alpha_max_q2_per_s2=alpha), gains.ki_a_per_q_s)._replace(value=alpha)


def best_alpha(tried: tuple[Tried, ...], cost: float) -> Tried | None:
    """The smallest alpha that passes with an error within `cost` of the least: it resets a wound-up integral soonest."""
    passed = [one for one in tried if one.passed]
    least = min((one.numbers[0] for one in passed), default=0.0)
    return min((one for one in passed if one.numbers[0] <= (1.0 + cost) * least), default=None)


def best_integral(found: Found) -> Tried | None:
    """Of the K_I that passed with all below them, the one with the least error."""
    return min(found.passed, key=lambda one: one.numbers[0], default=None)


def morse(bench: Bench, gains: LinkGains) -> tuple[Step, ...]:
    """Steps 3 and 4: K_I, then alpha_max."""
    tuned = tune(bench, gains)
    return integral_step(bench, tuned), alpha_step(bench, tuned)


def tune(bench: Bench, gains: LinkGains) -> Tuned:
    """K_I where alpha is so large that only true wind-up resets the integral, then alpha at that K_I."""
    criteria, first = bench.criteria, gains.linear_ki_a_per_q_s
    alphas = tuple(share * gains.qd_max_q_per_s * gains.qd_max_q_per_s for share in ALPHAS)
    free = gains._replace(alpha_max_q2_per_s2=alphas[-1])
    found = largest(
        lambda value: judge_integral(bench, free, value),
        start=first,
        factor=FACTOR,
        ceiling=first * WIDEST,
        floor=first / WIDEST,
        precision=criteria.precision,
    )
    best = best_integral(found)
    if best is None:
        return Tuned(found, None, (), None)
    tuned = free._replace(ki_a_per_q_s=best.value)
    tried = tuple(judge_alpha(bench, tuned, alpha) for alpha in alphas)
    chosen = best_alpha(tried, criteria.alpha_cost)
    return Tuned(found, tuned, tried, None if chosen is None else tuned._replace(alpha_max_q2_per_s2=chosen.value))


def limit(found: Found, best: Tried, criteria: Criteria, printed: float) -> str:
    """What keeps K_I from being larger, as a phrase."""
    failed = next((one for one in found.tried if not one.passed), None)
    if best is not found.largest or failed is None:
        return "the error of the ramp is least there"
    return f"the error still falls, but at {failed.value / printed:.4g} {suffers(criteria, failed.numbers)}"


def integral_step(bench: Bench, tuned: Tuned) -> Step:
    """Step 3: what was tried for K_I."""
    criteria, printed, scale = bench.criteria, a_per_printed(bench.link), rad_per_unit(bench.link)
    name, best = f"mA/({unit(bench.link)} s)", best_integral(tuned.integral)
    decision = "every K_I that was tried rings, hunts, overshoots or trips"
    if best is not None:
        decision = f"{best.value / printed:.4g} {name}: {limit(tuned.integral, best, criteria, printed)}"
    return Step(
        number=3,
        title="optimum K_I, modified Morse law",
        rule=f"least error of the fastest ramp; nothing rings or hunts, the small step overshoots by at most "
        f"{criteria.overshoot_counts:g} counts, the sine's large swings by at most {criteria.swing_ratio - 1.0:.0%}",
        columns=(f"K_I {name}", *headings(bench)),
        rows=tuple((o.value / printed, o.numbers[0] / scale, *o.numbers[1:], yes(o.passed)) for o in tuned.integral.tried),
        decision=decision,
        gains=tuned.with_integral,
    )


def alpha_step(bench: Bench, tuned: Tuned) -> Step:
    """Step 4: what was tried for alpha at that K_I."""
    scale = rad_per_unit(bench.link)
    square, name, cost = scale * scale, f"{unit(bench.link)}2/s2", bench.criteria.alpha_cost
    decision = "at every alpha that was tried a pattern suffers"
    if tuned.gains is not None:
        decision = f"{tuned.gains.alpha_max_q2_per_s2 / square:.4g} {name}"
    return Step(
        number=4,
        title="alpha_max: optimum alpha, modified Morse law",
        rule=f"the smallest alpha whose error on the fastest ramp is within {cost:.0%} of the least; patterns as in step 3",
        columns=(f"alpha {name}", *headings(bench)),
        rows=tuple((o.value / square, o.numbers[0] / scale, *o.numbers[1:], yes(o.passed)) for o in tuned.alphas),
        decision=decision,
        gains=tuned.gains,
    )


def headings(bench: Bench) -> tuple[str, ...]:
    """Headings of what both steps measure."""
    error = f"ramp rms {unit(bench.link)}"
    return (error, "ripple early", "late, counts", "turns at rest", "step over, counts", "sine swing", "good")
