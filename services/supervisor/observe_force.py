"""What one reading of the gauge says beside its value: noise, smooth course, work done, what motion can explain."""

from typing import NamedTuple

from hydrohil.services.supervisor.machine import COUNT_M, GAUGE_N_PER_M, GAUGE_NS_PER_M, LOOSE_M_PER_S, NOISE_N
from hydrohil.services.supervisor.rule import GaugeObservation
from hydrohil.shared.compiled.kernel import kernel

SMOOTHING_S = 0.02


class ForceWatch(NamedTuple):
    """What is remembered of the force; all in raw newtons, so that a bias that is still being taken moves nothing."""

    counts: int
    raw_n: float
    smooth_n: float
    explained_n: float
    quiet_samples: int
    held_ns: int
    energy_j: float


class Push(NamedTuple):
    """How the tip went along the gauge, positive into the environment; and what the force is counted from."""

    follows: bool  # the sample before is known
    way_m: float  # since then
    speed_m_per_s: float  # smooth
    dt_ns: int
    bias_n: float
    bias_spread_n: float


@kernel
def force_begin(counts: int, raw_n: float) -> ForceWatch:
    """Every window at its first reading."""
    return ForceWatch(counts, raw_n, raw_n, raw_n, 0, 0, 0.0)


@kernel
def force_step(
    watch: ForceWatch, push: Push, counts: int, raw_n: float, quiet_counts: int, level_n: float
) -> tuple[ForceWatch, GaugeObservation]:
    """One reading taken in.

    smooth   s += (f - s) dt / (tau + dt),  its slope is  (f - s) / tau  after the step
    energy   E += (s - bias) dp,  never below 0, of one contact: none while s is within the noise of the bias
    jump     |df| <= 2 noise + (k dt + c) (|v| + count / tau): gauge k, c in series bounds every environment
    course   f <= u + 2 noise + k count + c (|v| + loose),  u <- min(u + k max(dp, 0), f + c |v|): a push grows only by going in
    """
    dt_s = push.dt_ns * 1e-9
    if not push.follows:
        watch = force_begin(counts, raw_n)
    smooth_n = watch.smooth_n + (raw_n - watch.smooth_n) * dt_s / (SMOOTHING_S + dt_s)
    tared_n = smooth_n - push.bias_n
    quiet = push.follows and push.dt_ns > 0 and abs(counts - watch.counts) <= quiet_counts
    quiet_samples = watch.quiet_samples + 1 if quiet else 0
    held_ns = watch.held_ns + push.dt_ns if tared_n > level_n else 0
    energy_j = _energy(watch.energy_j, tared_n, push.way_m)
    explained_n = watch.explained_n + GAUGE_N_PER_M * max(0.0, push.way_m)  # a NaN is no way
    speed = abs(push.speed_m_per_s)
    seen = GaugeObservation(
        counts,
        raw_n,
        raw_n - push.bias_n,
        push.bias_n,
        push.bias_spread_n,
        tared_n,
        (raw_n - smooth_n) / SMOOTHING_S,
        raw_n - watch.raw_n,
        2.0 * NOISE_N + (GAUGE_N_PER_M * dt_s + GAUGE_NS_PER_M) * (speed + COUNT_M / (SMOOTHING_S + dt_s)),
        raw_n - explained_n,
        2.0 * NOISE_N + GAUGE_N_PER_M * COUNT_M + GAUGE_NS_PER_M * (speed + LOOSE_M_PER_S),
        quiet_samples,
        held_ns,
        energy_j,
    )
    at_most_n = raw_n + GAUGE_NS_PER_M * speed  # a crate that slides ahead takes that much off the reading
    return ForceWatch(counts, raw_n, smooth_n, min(at_most_n, explained_n), quiet_samples, held_ns, energy_j), seen


@kernel
def _energy(energy_j: float, tared_n: float, way_m: float) -> float:
    if tared_n <= NOISE_N or energy_j != energy_j:
        return 0.0
    return max(energy_j + tared_n * way_m, 0.0)  # a NaN stays one
