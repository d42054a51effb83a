"""Steps 1 and 2 of Appendix C: maximum stable proportional gain by P control, then the maximum integral gain of linear PI."""

import math

import numpy as np

from hydrohil.claims.signals import JOINTS, count_size
from hydrohil.experiment.sections import LinkGains
from hydrohil.shared.contract.link_units import written_name
from hydrohil.shared.machine.description import LINKS
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.tuning import measure
from hydrohil.tuning.bench import Bench, Step, a_per_printed, play, rad_per_unit, rings_on, unit, worst_ringing, yes
from hydrohil.tuning.patterns import pattern
from hydrohil.tuning.search import Found, Tried, largest

FULL_CURRENT_A = 2048 / UNIMATE.drive.counts_per_a  # where the program's control saturates
FIRST_SHARE = 0.25  # the first K_P commands full current at this share of the large pattern
FIRST_RATE_PER_S = 0.1  # the first K_I over K_P: an integral that takes 10 s for what the error does at once
FACTOR = math.sqrt(2.0)
WIDEST = 1024.0  # gains are sought this far from the first
FOLLOWS = 0.9  # of the set speed: below, the link does not follow and its ripple says nothing


def judge_proportional(bench: Bench, gains: LinkGains, value: float) -> Tried:
    """Ringing at constant speed, turns at rest and share of the set speed under P control; the worst seed."""
    setpoint, link = pattern("large-ramp", bench.link, gains), bench.link
    traces = play(bench, "pi", gains._replace(kp_a_per_q=value, linear_ki_a_per_q_s=0.0), setpoint)
    if traces is None:
        return Tried(value, False, (math.inf, math.inf, math.inf, 0.0))
    ring = worst_ringing(bench, traces, setpoint)
    hunting = max(measure.hunting(trace, link, setpoint) for trace in traces)
    share = min(measure.cruise_share(trace, link, setpoint) for trace in traces)
    steady = not rings_on(bench.criteria, ring) and hunting <= bench.criteria.hunting
    return Tried(value, steady, (*ring, float(hunting), share))


def proportional(bench: Bench, gains: LinkGains) -> Step:
    """Step 1: the largest K_P of P control whose ringing dies away on the large ramp, less the margin."""
    setpoint = pattern("large-ramp", bench.link, gains)
    first = FULL_CURRENT_A / (FIRST_SHARE * setpoint.size_q)
    ceiling = FULL_CURRENT_A / count_size(JOINTS[bench.link])  # at which one count commands full current
    found = largest(
        lambda value: judge_proportional(bench, gains, value),
        start=first,
        factor=FACTOR,
        ceiling=ceiling,
        floor=first / WIDEST,
        precision=bench.criteria.precision,
    )
    return proportional_step(bench, gains, found)


def proportional_step(bench: Bench, gains: LinkGains, found: Found) -> Step:
    """What step 1 makes of the values tried."""
    criteria, printed, name = bench.criteria, a_per_printed(bench.link), f"mA/{unit(bench.link)}"
    best, value = found.largest, None
    if best is None:
        decision = "every gain that was tried rings on, hunts or trips"
    elif not found.bounded:
        decision = "no gain rings, up to full current for one encoder count: does the link move?"
    elif best.numbers[3] < FOLLOWS:
        decision = (
            f"the link reaches {best.numbers[3]:.0%} of the set speed: it is stuck or too slow; "
            f"lower the link's {written_name('qd_max_q_per_s', LINKS[bench.link])}, or look at supply and friction"
        )
    else:
        value = best.value / criteria.margin
        decision = f"largest stable {best.value / printed:.4g} over the margin {criteria.margin:g}: {value / printed:.4g} {name}"
    return Step(
        number=1,
        title="maximum stable proportional gain, linear P control",
        rule=f"large ramp: error ripple above {criteria.ripple_counts:g} counts dies away at constant speed; no hunting at rest",
        columns=(f"K_P {name}", "ripple early", "late, counts", "turns at rest", "speed/set", "stable"),
        rows=tuple((one.value / printed, *one.numbers, yes(one.passed)) for one in found.tried),
        decision=decision,
        gains=None if value is None else gains._replace(kp_a_per_q=value),
    )


def judge_integral(bench: Bench, gains: LinkGains, value: float) -> Tried:
    """Wind-up on the large step, ringing, turns at rest and error on the large ramp under linear PI; the worst seed."""
    link, criteria, tried = bench.link, bench.criteria, gains._replace(linear_ki_a_per_q_s=value)
    step, ramp = pattern("large-step", link, gains), pattern("large-ramp", link, gains)
    stepped, ramped = play(bench, "pi", tried, step), play(bench, "pi", tried, ramp)
    if stepped is None or ramped is None:
        return Tried(value, False, (math.inf,) * 5)
    windup = max(measure.overshoot_q(trace, link, step) for trace in stepped) / step.size_q
    ring = worst_ringing(bench, ramped, ramp)
    hunting = max(measure.hunting(trace, link, ramp) for trace in ramped)
    error = float(np.median([measure.rms_error_q(trace, link) for trace in ramped]))
    steady = not rings_on(bench.criteria, ring) and hunting <= criteria.hunting
    return Tried(value, steady and windup <= criteria.windup_share, (windup, *ring, float(hunting), error))


def integral(bench: Bench, gains: LinkGains) -> Step:
    """Step 2: the largest K_I of linear PI that is stable and winds up by no more than a share of the large step."""
    first = gains.kp_a_per_q * FIRST_RATE_PER_S
    found = largest(
        lambda value: judge_integral(bench, gains, value),
        start=first,
        factor=FACTOR,
        ceiling=first * WIDEST,
        floor=first / WIDEST,
        precision=bench.criteria.precision,
    )
    return integral_step(bench, gains, found)


def integral_step(bench: Bench, gains: LinkGains, found: Found) -> Step:
    """What step 2 makes of the values tried."""
    criteria, printed, name = bench.criteria, a_per_printed(bench.link), f"mA/({unit(bench.link)} s)"
    best, scale = found.largest, rad_per_unit(bench.link)
    decision = "every gain that was tried winds up too far, rings or trips"
    if best is not None:
        decision = f"largest {best.value / printed:.4g} {name}" + ("" if found.bounded else ": no limit was met")
    return Step(
        number=2,
        title="maximum integral gain, linear PI",
        rule=f"large step: wind-up overshoots by at most {criteria.windup_share:.0%} of it; large ramp as in step 1",
        columns=(
            f"K_I {name}",
            "overshoot/step",
            "ripple early",
            "late, counts",
            "turns at rest",
            f"ramp rms {unit(bench.link)}",
            "good",
        ),
        rows=tuple((o.value / printed, *o.numbers[:4], o.numbers[4] / scale, yes(o.passed)) for o in found.tried),
        decision=decision,
        gains=None if best is None else gains._replace(linear_ki_a_per_q_s=best.value),
    )
