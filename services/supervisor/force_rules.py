"""What must hold of the force gauge and of the force that it reads."""

from hydrohil.services.supervisor.machine import NOISE_N, TOUCH_N
from hydrohil.services.supervisor.rule import Limits, Observed, Rule
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import TripCause


@kernel
def force_reading_valid(seen: Observed, limits: Limits) -> bool:
    return limits.min_force_counts <= seen.gauge.force_counts < limits.max_force_counts


@kernel
def raw_force_within(seen: Observed, limits: Limits) -> bool:
    return abs(seen.gauge.raw_n) <= limits.config.raw_force_limit_n


@kernel
def tared_force_within(seen: Observed, limits: Limits) -> bool:
    return abs(seen.gauge.tared_n) <= limits.config.force_limit_n


@kernel
def gauge_alive(seen: Observed, limits: Limits) -> bool:
    return seen.gauge.quiet_samples < limits.quiet_samples


@kernel
def force_steady(seen: Observed, limits: Limits) -> bool:
    return abs(seen.gauge.jump_n) <= seen.gauge.jump_limit_n


@kernel
def force_rate_within(seen: Observed, limits: Limits) -> bool:
    return abs(seen.gauge.rate_n_per_s) <= limits.config.force_rate_limit_n_per_s


@kernel
def contact_brief(seen: Observed, limits: Limits) -> bool:
    return seen.gauge.held_ns * 1e-9 <= limits.config.contact_time_s


@kernel
def energy_within(seen: Observed, limits: Limits) -> bool:
    return seen.gauge.energy_j <= limits.config.contact_energy_j


@kernel
def force_explained(seen: Observed, limits: Limits) -> bool:
    return not seen.moving or seen.gauge.unexplained_n <= seen.gauge.unexplained_limit_n


@kernel
def force_pushes(seen: Observed, limits: Limits) -> bool:
    return not seen.moving or seen.gauge.smooth_n >= -(NOISE_N + TOUCH_N)


@kernel
def bias_steady(seen: Observed, limits: Limits) -> bool:
    return not seen.starting or (
        abs(seen.gauge.bias_n) <= limits.config.bias_limit_n and seen.gauge.bias_spread_n <= limits.config.bias_spread_n
    )


FORCE_RULES = (
    Rule(
        force_reading_valid,
        TripCause.FORCE_INVALID,
        lambda seen, _: float(seen.gauge.force_counts),
        lambda seen, limits: float(
            limits.min_force_counts if seen.gauge.force_counts < limits.min_force_counts else limits.max_force_counts
        ),
    ),
    Rule(
        raw_force_within,
        TripCause.FORCE_RAW,
        lambda seen, _: seen.gauge.raw_n,
        lambda _, limits: limits.config.raw_force_limit_n,
    ),
    Rule(
        tared_force_within,
        TripCause.FORCE_TARED,
        lambda seen, _: seen.gauge.tared_n,
        lambda _, limits: limits.config.force_limit_n,
    ),
    Rule(
        gauge_alive,
        TripCause.FORCE_FROZEN,
        lambda seen, _: float(seen.gauge.quiet_samples),
        lambda _, limits: float(limits.quiet_samples),
    ),
    Rule(
        force_steady,
        TripCause.FORCE_JUMP,
        lambda seen, _: seen.gauge.jump_n,
        lambda seen, _: seen.gauge.jump_limit_n,
    ),
    Rule(
        force_rate_within,
        TripCause.FORCE_RATE,
        lambda seen, _: seen.gauge.rate_n_per_s,
        lambda _, limits: limits.config.force_rate_limit_n_per_s,
    ),
    Rule(
        contact_brief,
        TripCause.FORCE_HELD,
        lambda seen, _: seen.gauge.held_ns * 1e-9,
        lambda _, limits: limits.config.contact_time_s,
    ),
    Rule(
        energy_within,
        TripCause.FORCE_ENERGY,
        lambda seen, _: seen.gauge.energy_j,
        lambda _, limits: limits.config.contact_energy_j,
    ),
    Rule(
        force_explained,
        TripCause.FORCE_DRIFT,
        lambda seen, _: seen.gauge.unexplained_n,
        lambda seen, _: seen.gauge.unexplained_limit_n,
    ),
    Rule(
        force_pushes,
        TripCause.FORCE_BELOW_BIAS,
        lambda seen, _: seen.gauge.smooth_n,
        lambda _, __: -(NOISE_N + TOUCH_N),
    ),
    Rule(
        bias_steady,
        TripCause.BIAS,
        lambda seen, limits: (
            seen.gauge.bias_spread_n if abs(seen.gauge.bias_n) <= limits.config.bias_limit_n else seen.gauge.bias_n
        ),
        lambda seen, limits: (
            limits.config.bias_spread_n if abs(seen.gauge.bias_n) <= limits.config.bias_limit_n else limits.config.bias_limit_n
        ),
    ),
)
