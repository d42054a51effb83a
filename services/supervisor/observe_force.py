"""What one reading of the gauge says besides its value: noise, the smooth force, work done, what motion can explain."""

from typing import NamedTuple

from hydrohil.services.supervisor.rule import GaugeObservation
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.machine.description import Gauge

SMOOTHING_S = 0.02
LOOSE_M_PER_S = 0.03  # a crate that breaks loose runs ahead: (232 - 182 N) / sqrt(46 kN/m 64 kg)  (thesis 5.5)


class ForceMemory(NamedTuple):
    """What is remembered of the force; all in raw newtons, so that a bias that is still being taken moves nothing."""

    counts: int
    raw_n: float
    smooth_n: float
    explained_n: float
    quiet_samples: int
    held_ns: int
    energy_j: float


class GaugeMotion(NamedTuple):
    """How the tip moved along the gauge, positive into the environment, and the bias that the force is counted from."""

    follows: bool  # the sample before is known
    way_m: float  # since then
    speed_m_per_s: float  # smooth
    dt_ns: int
    bias_n: float
    bias_spread_n: float


@kernel
def force_begin(counts: int, raw_n: float) -> ForceMemory:
    """Every window at its first reading."""
    return ForceMemory(counts=counts, raw_n=raw_n, smooth_n=raw_n, explained_n=raw_n, quiet_samples=0, held_ns=0, energy_j=0.0)


@kernel
def force_step(
    memory: ForceMemory,
    gauge: Gauge,
    motion: GaugeMotion,
    counts: int,
    raw_n: float,
    tip_count_m: float,
    quiet_counts: int,
    level_n: float,
) -> tuple[ForceMemory, GaugeObservation]:
    """Take one reading in.

    smooth       s += (f - s) dt / (tau + dt),  its slope is  (f - s) / tau  after the step
    energy       E += (s - bias) dp,  never below 0, of one contact: none while s is within the noise of the bias
    jump         |df| <= 2 noise + (k dt + c) (|v| + count / tau): gauge k, c in series bounds every environment
    unexplained  f <= u + 2 noise + k count + c (|v| + loose),  u <- min(u + k max(dp, 0), f + c |v|): only a way in raises u
    """
    dt_s = motion.dt_ns * 1e-9
    if not motion.follows:
        memory = force_begin(counts, raw_n)
    smooth_n = memory.smooth_n + (raw_n - memory.smooth_n) * dt_s / (SMOOTHING_S + dt_s)
    tared_n = smooth_n - motion.bias_n
    quiet = motion.follows and motion.dt_ns > 0 and abs(counts - memory.counts) <= quiet_counts
    quiet_samples = memory.quiet_samples + 1 if quiet else 0
    held_ns = memory.held_ns + motion.dt_ns if tared_n > level_n else 0
    energy_j = _energy(memory.energy_j, gauge.noise_n, tared_n, motion.way_m)
    explained_n = memory.explained_n + gauge.stiffness_n_per_m * max(0.0, motion.way_m)  # a NaN is not added to the way
    speed = abs(motion.speed_m_per_s)
    observed = GaugeObservation(
        force_counts=counts,
        raw_n=raw_n,
        tared_n=raw_n - motion.bias_n,
        bias_n=motion.bias_n,
        bias_spread_n=motion.bias_spread_n,
        smooth_n=tared_n,
        rate_n_per_s=(raw_n - smooth_n) / SMOOTHING_S,
        jump_n=raw_n - memory.raw_n,
        jump_limit_n=_jump_limit(gauge, tip_count_m, speed, dt_s),
        unexplained_n=raw_n - explained_n,
        unexplained_limit_n=_unexplained_limit(gauge, tip_count_m, speed),
        quiet_samples=quiet_samples,
        held_ns=held_ns,
        energy_j=energy_j,
    )
    at_most_n = raw_n + gauge.damping_ns_per_m * speed  # a crate that slides ahead takes that much off the reading
    after = ForceMemory(
        counts=counts,
        raw_n=raw_n,
        smooth_n=smooth_n,
        explained_n=min(at_most_n, explained_n),
        quiet_samples=quiet_samples,
        held_ns=held_ns,
        energy_j=energy_j,
    )
    return after, observed


@kernel
def _jump_limit(gauge: Gauge, tip_count_m: float, speed_m_per_s: float, dt_s: float) -> float:
    """Largest step of the reading, in N, that noise and the gauge's own spring and damper explain at this speed."""
    speed_error = tip_count_m / (SMOOTHING_S + dt_s)  # what one count adds to the smooth speed
    return 2.0 * gauge.noise_n + (gauge.stiffness_n_per_m * dt_s + gauge.damping_ns_per_m) * (speed_m_per_s + speed_error)


@kernel
def _unexplained_limit(gauge: Gauge, tip_count_m: float, speed_m_per_s: float) -> float:
    """Largest reading above what the way into the environment explains, in N: noise, one count, and the damper."""
    return 2.0 * gauge.noise_n + gauge.stiffness_n_per_m * tip_count_m + gauge.damping_ns_per_m * (speed_m_per_s + LOOSE_M_PER_S)


@kernel
def _energy(energy_j: float, noise_n: float, tared_n: float, way_m: float) -> float:
    if tared_n <= noise_n or energy_j != energy_j:
        return 0.0
    return max(energy_j + tared_n * way_m, 0.0)  # a NaN stays one
