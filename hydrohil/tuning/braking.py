"""Step 6 of Appendix C: the braking gain K_a of the final law, on the ramp and the sine."""

import math
from typing import NamedTuple

import numpy as np

from hydrohil.experiment.sections import LinkGains
from hydrohil.tuning import measure
from hydrohil.tuning.bench import Bench, Step, a_per_printed, play, rad_per_unit, unit
from hydrohil.tuning.patterns import pattern

SHARES = (0.0, *(2.0 ** (power / 2.0) for power in range(-6, 3)))  # K_a over the current that holds the ramp per its speed
WIDER = 2.0**0.5  # beyond them, as long as the error falls
MOST_SHARE = 32.0
FINE = (2.0**-0.25, 2.0**0.25)  # about the best of those


class Braked(NamedTuple):
    """One K_a: median errors of the fastest ramp and the sine, the ramp's overshoot, and the sine's large swings."""

    ka_a_s_per_q: float
    ramp_q: float
    sine_q: float
    overshoot_q: float
    swing: float


def judge(bench: Bench, gains: LinkGains, value: float) -> Braked:
    """Play ramp and sine under the final law; errors are infinite if a trial trips."""
    link, tried = bench.link, gains._replace(ka_a_s_per_q=value)
    ramp, sine = pattern("large-ramp", link, gains), pattern("sine", link, gains)
    ramped, waved = play(bench, "final", tried, ramp), play(bench, "final", tried, sine)
    if ramped is None or waved is None:
        return Braked(ka_a_s_per_q=value, ramp_q=math.inf, sine_q=math.inf, overshoot_q=math.inf, swing=math.inf)
    return Braked(
        ka_a_s_per_q=value,
        ramp_q=float(np.median([measure.rms_error_q(trace, link) for trace in ramped])),
        sine_q=float(np.median([measure.rms_error_q(trace, link) for trace in waved])),
        overshoot_q=float(np.median([measure.overshoot_q(trace, link, ramp) for trace in ramped])),
        swing=float(np.median([measure.large_swings(trace, link) for trace in waved])),
    )


def cost(one: Braked, without: Braked) -> float:
    """Mean of both errors, each over what it is without braking: ramp and sine count alike."""
    return 0.5 * (one.ramp_q / without.ramp_q + one.sine_q / without.sine_q)


def holding_current_a(bench: Bench, gains: LinkGains) -> float:
    """Current that holds the fastest ramp's speed: the integral that braking has to take back."""
    ramp = pattern("large-ramp", bench.link, gains)
    traces = play(bench, "vetia", gains, ramp) or ()
    return float(np.median([measure.cruise_current_a(trace, bench.link, ramp) for trace in traces])) if traces else math.nan


def braking(bench: Bench, gains: LinkGains) -> Step:
    """Step 6: the K_a with the least error on ramp and sine."""
    natural = holding_current_a(bench, gains) / gains.qd_max_q_per_s
    tried = tuple(judge(bench, gains, share * natural) for share in SHARES) if math.isfinite(natural) else ()
    if not tried or not math.isfinite(tried[0].ramp_q):
        return braking_step(bench, gains, tried, None)
    while best_of(tried) is tried[-1] and tried[-1].ka_a_s_per_q * WIDER <= MOST_SHARE * natural:
        tried += (judge(bench, gains, tried[-1].ka_a_s_per_q * WIDER),)
    middle = best_of(tried).ka_a_s_per_q
    tried += tuple(judge(bench, gains, share * middle) for share in FINE if middle > 0.0)
    return braking_step(bench, gains, tried, best_of(tried))


def best_of(tried: tuple[Braked, ...]) -> Braked:
    """The least cost; the first tried is without braking."""
    return min(tried, key=lambda one: cost(one, tried[0]))


def braking_step(bench: Bench, gains: LinkGains, tried: tuple[Braked, ...], best: Braked | None) -> Step:
    """What step 6 makes of the values tried."""
    printed, scale, name = a_per_printed(bench.link), rad_per_unit(bench.link), unit(bench.link)
    decision = "without braking the ramp or the sine trips under the final law"
    if best is not None:
        decision = f"{best.ka_a_s_per_q / printed:.4g} mA s/{name}: errors {cost(best, tried[0]):.0%} of those without braking"
    return Step(
        number=6,
        title="braking acceleration: optimum K_a, final law",
        rule="least error on the fastest ramp and the sine, each over its error without braking",
        columns=(f"K_a mA s/{name}", f"ramp rms {name}", f"sine rms {name}", "mean share", f"ramp over {name}", "sine swing"),
        rows=tuple(
            (
                o.ka_a_s_per_q / printed,
                o.ramp_q / scale,
                o.sine_q / scale,
                cost(o, tried[0]),
                o.overshoot_q / scale,
                o.swing,
            )
            for o in sorted(tried)
        ),
        decision=decision,
        gains=None if best is None else gains._replace(ka_a_s_per_q=best.ka_a_s_per_q),
    )
