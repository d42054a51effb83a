"""The rules as rows: what must hold, the cause if it does not, and the words. Most severe first; the first broken decides."""

from collections.abc import Callable
from typing import NamedTuple

from services.supervisor.config import SupervisorConfig
from shared.kernel import kernel
from shared.messages import GateState, TripCause

_OPEN, _BURNED = int(GateState.OPEN), int(GateState.BURNED)


class Observed(NamedTuple):
    """What the rules judge, computed from one sample and what came before it."""

    moving: bool  # a trial runs and its tick is 0 or later, or its samples went back
    starting: bool  # a trial runs and its tick is -1 or later: what must hold before motion starts
    force_counts: int
    force_raw_n: float
    force_tared_n: float
    bias_n: float
    bias_spread_n: float
    q_rad: tuple[float, float, float]
    tip_m: tuple[float, float, float]
    lost_samples: int  # between this sample and the one before
    stale_ns: int  # wall time without a sample, 0 when one came
    command_lag: int  # samples since the one that the newest command answers
    gate: int
    tick: int
    ready: bool  # the controller says so


class Limits(NamedTuple):
    """The experiment's limits and those of the transport."""

    config: SupervisorConfig
    min_force_counts: int
    max_force_counts: int
    lease_samples: int
    lease_ns: int


class Rule(NamedTuple):
    """One row."""

    holds: Callable[[Observed, Limits], bool]
    cause: TripCause
    measured: Callable[[Observed, Limits], float]
    limit: Callable[[Observed, Limits], float]
    words: str


@kernel
def force_reading_valid(seen: Observed, limits: Limits) -> bool:
    return limits.min_force_counts <= seen.force_counts < limits.max_force_counts


@kernel
def raw_force_within(seen: Observed, limits: Limits) -> bool:
    return abs(seen.force_raw_n) <= limits.config.raw_force_limit_n


@kernel
def tared_force_within(seen: Observed, limits: Limits) -> bool:
    return abs(seen.force_tared_n) <= limits.config.force_limit_n


@kernel
def bias_steady(seen: Observed, limits: Limits) -> bool:
    return not seen.starting or (
        abs(seen.bias_n) <= limits.config.bias_limit_n and seen.bias_spread_n <= limits.config.bias_spread_n
    )


@kernel
def joints_within(seen: Observed, limits: Limits) -> bool:
    for link in range(3):
        if not limits.config.joint_low_rad[link] <= seen.q_rad[link] <= limits.config.joint_high_rad[link]:
            return False
    return True


@kernel
def tip_within(seen: Observed, limits: Limits) -> bool:
    for axis in range(3):
        if not limits.config.workspace_low_m[axis] <= seen.tip_m[axis] <= limits.config.workspace_high_m[axis]:
            return False
    return True


@kernel
def samples_complete(seen: Observed, limits: Limits) -> bool:
    return not seen.moving or 0 <= seen.lost_samples <= limits.lease_samples


@kernel
def samples_fresh(seen: Observed, limits: Limits) -> bool:
    return seen.stale_ns <= limits.lease_ns


@kernel
def commands_fresh(seen: Observed, limits: Limits) -> bool:
    return not (seen.moving and seen.tick > 0) or 0 <= seen.command_lag <= limits.lease_samples + 1


@kernel
def gate_holds(seen: Observed, limits: Limits) -> bool:
    return not seen.moving or seen.gate != _BURNED


@kernel
def controller_ready(seen: Observed, limits: Limits) -> bool:
    return not seen.starting or seen.ready


@kernel
def _worst(
    values: tuple[float, float, float], low: tuple[float, float, float], high: tuple[float, float, float]
) -> tuple[float, float]:
    """The first value outside its bounds and the bound it broke."""
    for i in range(3):
        if not low[i] <= values[i] <= high[i]:
            return values[i], high[i] if values[i] > high[i] else low[i]
    return values[0], high[0]


RULES = (
    Rule(
        force_reading_valid,
        TripCause.FORCE_INVALID,
        lambda seen, _: float(seen.force_counts),
        lambda seen, limits: float(
            limits.min_force_counts if seen.force_counts < limits.min_force_counts else limits.max_force_counts
        ),
        "the force reading is outside the gauge's range or saturated (counts)",
    ),
    Rule(
        raw_force_within,
        TripCause.FORCE_RAW,
        lambda seen, _: seen.force_raw_n,
        lambda _, limits: limits.config.raw_force_limit_n,
        "the raw force is above its limit (N)",
    ),
    Rule(
        tared_force_within,
        TripCause.FORCE_TARED,
        lambda seen, _: seen.force_tared_n,
        lambda _, limits: limits.config.force_limit_n,
        "the contact force is above its limit (N)",
    ),
    Rule(
        bias_steady,
        TripCause.BIAS,
        lambda seen, limits: seen.bias_spread_n if abs(seen.bias_n) <= limits.config.bias_limit_n else seen.bias_n,
        lambda seen, limits: (
            limits.config.bias_spread_n if abs(seen.bias_n) <= limits.config.bias_limit_n else limits.config.bias_limit_n
        ),
        "the force bias is above its limit or unsteady (N)",
    ),
    Rule(
        joints_within,
        TripCause.JOINT_LIMIT,
        lambda seen, limits: _worst(seen.q_rad, limits.config.joint_low_rad, limits.config.joint_high_rad)[0],
        lambda seen, limits: _worst(seen.q_rad, limits.config.joint_low_rad, limits.config.joint_high_rad)[1],
        "a joint is beyond its limit (rad; link 3 m)",
    ),
    Rule(
        tip_within,
        TripCause.WORKSPACE,
        lambda seen, limits: _worst(seen.tip_m, limits.config.workspace_low_m, limits.config.workspace_high_m)[0],
        lambda seen, limits: _worst(seen.tip_m, limits.config.workspace_low_m, limits.config.workspace_high_m)[1],
        "the tip has left its workspace (m)",
    ),
    Rule(
        samples_complete,
        TripCause.SAMPLE_LOST,
        lambda seen, _: float(seen.lost_samples),
        lambda seen, limits: float(limits.lease_samples if seen.lost_samples >= 0 else 0),
        "samples were lost for longer than the lease, or the plant started anew (samples)",
    ),
    Rule(
        samples_fresh,
        TripCause.SAMPLE_STALE,
        lambda seen, _: seen.stale_ns * 1e-9,
        lambda _, limits: limits.lease_ns * 1e-9,
        "the plant's samples have stopped (s)",
    ),
    Rule(
        commands_fresh,
        TripCause.COMMAND_STALE,
        lambda seen, _: float(seen.command_lag),
        lambda seen, limits: float(limits.lease_samples + 1 if seen.command_lag >= 0 else 0),
        "the controller's commands have stopped or stand still (samples)",
    ),
    Rule(
        gate_holds,
        TripCause.GATE_CUT,
        lambda seen, _: float(seen.gate),
        lambda _, __: float(_OPEN),
        "the gate has cut; its own event says why",
    ),
    Rule(
        controller_ready,
        TripCause.NOT_READY,
        lambda seen, _: 1.0 if seen.ready else 0.0,
        lambda _, __: 1.0,
        "the controller is not ready: buffers not full, or the reference does not start within 2 counts of the pose",
    ),
)
WORDS = {rule.cause: rule.words for rule in RULES} | {
    TripCause.NONE: "nothing",
    TripCause.ESTOP: "the operator's emergency stop",
}


def trip_words(cause: TripCause, measured: float, limit: float, number: int) -> str:
    """A trip for people: what no longer held, the number against its limit, and the sample at which."""
    numbers = "" if cause == TripCause.ESTOP else f": {measured:.4g} against {limit:.4g}"
    return f"{WORDS[cause]}{numbers} (sample {number})"


def fold(rules: tuple[Rule, ...]) -> Callable[[Observed, Limits], tuple[int, float, float]]:
    """One kernel of all rows: (cause, measured, limit) of the first that does not hold, (0, 0, 0) if all do."""
    chain: Callable[[Observed, Limits], tuple[int, float, float]] = _nothing_broken
    for rule in reversed(rules):
        chain = _before(rule.holds, int(rule.cause), kernel(rule.measured), kernel(rule.limit), chain)
    return chain


@kernel
def _nothing_broken(seen: Observed, limits: Limits) -> tuple[int, float, float]:
    return 0, 0.0, 0.0


def _before(
    holds: Callable[[Observed, Limits], bool],
    cause: int,
    measured: Callable[[Observed, Limits], float],
    limit: Callable[[Observed, Limits], float],
    rest: Callable[[Observed, Limits], tuple[int, float, float]],
) -> Callable[[Observed, Limits], tuple[int, float, float]]:
    @kernel
    def first_broken(seen: Observed, limits: Limits) -> tuple[int, float, float]:
        if not holds(seen, limits):
            return cause, measured(seen, limits), limit(seen, limits)
        return rest(seen, limits)

    return first_broken


first_broken = fold(RULES)
