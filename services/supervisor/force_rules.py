"""What must hold of the force gauge and of the force that it reads."""

from hydrohil.services.supervisor.rule import Limits, Observed, Rule
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import TripCause

TOUCH_N = 15.0  # the thesis' trials begin with the tool resting on the plate at 12 N while the bias is taken


@kernel
def force_reading_valid(observed: Observed, limits: Limits) -> bool:
    return limits.min_force_counts <= observed.gauge.force_counts < limits.max_force_counts


@kernel
def raw_force_within(observed: Observed, limits: Limits) -> bool:
    return abs(observed.gauge.raw_n) <= limits.config.raw_force_limit_n


@kernel
def tared_force_within(observed: Observed, limits: Limits) -> bool:
    return abs(observed.gauge.tared_n) <= limits.config.force_limit_n


@kernel
def gauge_alive(observed: Observed, limits: Limits) -> bool:
    return observed.gauge.quiet_samples < limits.quiet_samples


@kernel
def force_steady(observed: Observed, limits: Limits) -> bool:
    return abs(observed.gauge.jump_n) <= observed.gauge.jump_limit_n


@kernel
def force_rate_within(observed: Observed, limits: Limits) -> bool:
    return abs(observed.gauge.rate_n_per_s) <= limits.config.force_rate_limit_n_per_s


@kernel
def contact_brief(observed: Observed, limits: Limits) -> bool:
    return observed.gauge.held_ns * 1e-9 <= limits.config.contact_time_s


@kernel
def energy_within(observed: Observed, limits: Limits) -> bool:
    return observed.gauge.energy_j <= limits.config.contact_energy_j


@kernel
def force_explained(observed: Observed, limits: Limits) -> bool:
    return not observed.moving or observed.gauge.unexplained_n <= observed.gauge.unexplained_limit_n


@kernel
def force_pushes(observed: Observed, limits: Limits) -> bool:
    return not observed.moving or observed.gauge.smooth_n >= -(limits.gauge.noise_n + TOUCH_N)


@kernel
def bias_steady(observed: Observed, limits: Limits) -> bool:
    return not observed.starting or (
        abs(observed.gauge.bias_n) <= limits.config.bias_limit_n and observed.gauge.bias_spread_n <= limits.config.bias_spread_n
    )


FORCE_RULES = (
    Rule(
        holds=force_reading_valid,
        cause=TripCause.FORCE_INVALID,
        measured=lambda observed, _: float(observed.gauge.force_counts),
        limit=lambda observed, limits: float(
            limits.min_force_counts if observed.gauge.force_counts < limits.min_force_counts else limits.max_force_counts
        ),
    ),
    Rule(
        holds=raw_force_within,
        cause=TripCause.FORCE_RAW,
        measured=lambda observed, _: observed.gauge.raw_n,
        limit=lambda _, limits: limits.config.raw_force_limit_n,
    ),
    Rule(
        holds=tared_force_within,
        cause=TripCause.FORCE_TARED,
        measured=lambda observed, _: observed.gauge.tared_n,
        limit=lambda _, limits: limits.config.force_limit_n,
    ),
    Rule(
        holds=gauge_alive,
        cause=TripCause.FORCE_FROZEN,
        measured=lambda observed, _: float(observed.gauge.quiet_samples),
        limit=lambda _, limits: float(limits.quiet_samples),
    ),
    Rule(
        holds=force_steady,
        cause=TripCause.FORCE_JUMP,
        measured=lambda observed, _: observed.gauge.jump_n,
        limit=lambda observed, _: observed.gauge.jump_limit_n,
    ),
    Rule(
        holds=force_rate_within,
        cause=TripCause.FORCE_RATE,
        measured=lambda observed, _: observed.gauge.rate_n_per_s,
        limit=lambda _, limits: limits.config.force_rate_limit_n_per_s,
    ),
    Rule(
        holds=contact_brief,
        cause=TripCause.FORCE_HELD,
        measured=lambda observed, _: observed.gauge.held_ns * 1e-9,
        limit=lambda _, limits: limits.config.contact_time_s,
    ),
    Rule(
        holds=energy_within,
        cause=TripCause.FORCE_ENERGY,
        measured=lambda observed, _: observed.gauge.energy_j,
        limit=lambda _, limits: limits.config.contact_energy_j,
    ),
    Rule(
        holds=force_explained,
        cause=TripCause.FORCE_DRIFT,
        measured=lambda observed, _: observed.gauge.unexplained_n,
        limit=lambda observed, _: observed.gauge.unexplained_limit_n,
    ),
    Rule(
        holds=force_pushes,
        cause=TripCause.FORCE_BELOW_BIAS,
        measured=lambda observed, _: observed.gauge.smooth_n,
        limit=lambda _, limits: -(limits.gauge.noise_n + TOUCH_N),
    ),
    Rule(
        holds=bias_steady,
        cause=TripCause.BIAS,
        measured=lambda observed, limits: (
            observed.gauge.bias_spread_n if abs(observed.gauge.bias_n) <= limits.config.bias_limit_n else observed.gauge.bias_n
        ),
        limit=lambda observed, limits: (
            limits.config.bias_spread_n
            if abs(observed.gauge.bias_n) <= limits.config.bias_limit_n
            else limits.config.bias_limit_n
        ),
    ),
)
