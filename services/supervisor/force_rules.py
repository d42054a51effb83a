"""What must hold of the force gauge and of the force that it reads."""

from services.supervisor.rule import Limits, Observed, Rule
from shared.kernel import kernel
from shared.messages import TripCause


@kernel
def force_reading_valid(seen: Observed, limits: Limits) -> bool:
    return limits.min_force_counts <= seen.gauge.counts < limits.max_force_counts


@kernel
def raw_force_within(seen: Observed, limits: Limits) -> bool:
    return abs(seen.gauge.raw_n) <= limits.config.raw_force_limit_n


@kernel
def tared_force_within(seen: Observed, limits: Limits) -> bool:
    return abs(seen.gauge.tared_n) <= limits.config.force_limit_n


@kernel
def bias_steady(seen: Observed, limits: Limits) -> bool:
    return not seen.starting or (
        abs(seen.gauge.bias_n) <= limits.config.bias_limit_n and seen.gauge.bias_spread_n <= limits.config.bias_spread_n
    )


FORCE_RULES = (
    Rule(
        force_reading_valid,
        TripCause.FORCE_INVALID,
        lambda seen, _: float(seen.gauge.counts),
        lambda seen, limits: float(
            limits.min_force_counts if seen.gauge.counts < limits.min_force_counts else limits.max_force_counts
        ),
        "the force reading is outside the gauge's range or saturated (counts)",
    ),
    Rule(
        raw_force_within,
        TripCause.FORCE_RAW,
        lambda seen, _: seen.gauge.raw_n,
        lambda _, limits: limits.config.raw_force_limit_n,
        "the raw force is above its limit (N)",
    ),
    Rule(
        tared_force_within,
        TripCause.FORCE_TARED,
        lambda seen, _: seen.gauge.tared_n,
        lambda _, limits: limits.config.force_limit_n,
        "the contact force is above its limit (N)",
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
        "the force bias is above its limit or unsteady (N)",
    ),
)
