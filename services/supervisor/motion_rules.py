"""What must hold of the joints, the tip and the valves that move them."""

from hydrohil.services.supervisor.machine import BRAKES, FULL_SPEED, MOVES_WITHIN_NS
from hydrohil.services.supervisor.rule import Limits, Observed, Rule
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import TripCause
from hydrohil.shared.contract.pose import Triple


@kernel
def counters_connected(seen: Observed, limits: Limits) -> bool:
    return _off_rail(seen.motion.counts, limits) == 3


@kernel
def counters_follow(seen: Observed, limits: Limits) -> bool:
    return _first_jump(seen, limits) == 4


@kernel
def links_obey(seen: Observed, limits: Limits) -> bool:
    return _first_above(seen.motion.against, BRAKES) == 3


@kernel
def links_move(seen: Observed, limits: Limits) -> bool:
    for link in range(3):
        if not seen.motion.idle_ns[link] <= MOVES_WITHIN_NS:
            return False
    return True


@kernel
def joints_within(seen: Observed, limits: Limits) -> bool:
    for link in range(3):
        if not limits.config.joint_low_q[link] <= seen.motion.q[link] <= limits.config.joint_high_q[link]:
            return False
    return True


@kernel
def tip_within(seen: Observed, limits: Limits) -> bool:
    for axis in range(3):
        if not limits.config.workspace_low_m[axis] <= seen.motion.tip_m[axis] <= limits.config.workspace_high_m[axis]:
            return False
    return True


@kernel
def joints_slow(seen: Observed, limits: Limits) -> bool:
    return _first_above(seen.motion.speed, limits.config.joint_speed_limit) == 3


@kernel
def tip_slow(seen: Observed, limits: Limits) -> bool:
    return seen.motion.tip_speed_m_per_s <= limits.config.tip_speed_limit_m_per_s


@kernel
def _off_rail(counts: tuple[int, int, int], limits: Limits) -> int:
    """The first counter at or beyond an end, 3 if none."""
    for link in range(3):
        if not limits.low_counts[link] < counts[link] < limits.high_counts[link]:
            return link
    return 3


@kernel
def _rail(counts: tuple[int, int, int], limits: Limits) -> int:
    """The end at or beyond which that counter stands."""
    link = _off_rail(counts, limits) % 3
    return limits.low_counts[link] if counts[link] <= limits.low_counts[link] else limits.high_counts[link]


@kernel
def _reach(seen: Observed, limits: Limits, encoder: int) -> float:
    """What an encoder can have moved since the sample before: full speed, and the count that a floor may add."""
    return FULL_SPEED[encoder] * seen.motion.dt_s + limits.count_q[encoder] * (1.0 + 1e-9)


@kernel
def _first_jump(seen: Observed, limits: Limits) -> int:
    """The first encoder that moved further than it can, 4 if none."""
    for encoder in range(4):
        if not abs(seen.motion.moved_q[encoder]) <= _reach(seen, limits, encoder):
            return encoder
    return 4


@kernel
def _first_above(values: Triple, limits: Triple) -> int:
    """The first value beyond its limit, either way; 3 if none."""
    for link in range(3):
        if not abs(values[link]) <= limits[link]:
            return link
    return 3


@kernel
def _least_progress(seen: Observed) -> int:
    """The link that has been idle for longest, in ns."""
    idle = seen.motion.idle_ns
    return max(idle[0], idle[1], idle[2])


@kernel
def _worst(values: Triple, low: Triple, high: Triple) -> tuple[float, float]:
    """The first value outside its bounds and the bound it broke."""
    for i in range(3):
        if not low[i] <= values[i] <= high[i]:
            return values[i], high[i] if values[i] > high[i] else low[i]
    return values[0], high[0]


MOTION_RULES = (
    Rule(
        counters_connected,
        TripCause.ENCODER_INVALID,
        lambda seen, limits: float(seen.motion.counts[_off_rail(seen.motion.counts, limits) % 3]),
        lambda seen, limits: float(_rail(seen.motion.counts, limits)),
    ),
    Rule(
        counters_follow,
        TripCause.ENCODER_JUMP,
        lambda seen, limits: seen.motion.moved_q[_first_jump(seen, limits) % 4],
        lambda seen, limits: _reach(seen, limits, _first_jump(seen, limits) % 4),
    ),
    Rule(
        links_obey,
        TripCause.MOTION_AGAINST,
        lambda seen, _: seen.motion.against[_first_above(seen.motion.against, BRAKES) % 3],
        lambda seen, _: BRAKES[_first_above(seen.motion.against, BRAKES) % 3],
    ),
    Rule(
        links_move,
        TripCause.NO_MOTION,
        lambda seen, _: _least_progress(seen) * 1e-9,
        lambda _, __: MOVES_WITHIN_NS * 1e-9,
    ),
    Rule(
        joints_within,
        TripCause.JOINT_LIMIT,
        lambda seen, limits: _worst(seen.motion.q, limits.config.joint_low_q, limits.config.joint_high_q)[0],
        lambda seen, limits: _worst(seen.motion.q, limits.config.joint_low_q, limits.config.joint_high_q)[1],
    ),
    Rule(
        tip_within,
        TripCause.WORKSPACE,
        lambda seen, limits: _worst(seen.motion.tip_m, limits.config.workspace_low_m, limits.config.workspace_high_m)[0],
        lambda seen, limits: _worst(seen.motion.tip_m, limits.config.workspace_low_m, limits.config.workspace_high_m)[1],
    ),
    Rule(
        joints_slow,
        TripCause.JOINT_SPEED,
        lambda seen, limits: seen.motion.speed[_first_above(seen.motion.speed, limits.config.joint_speed_limit) % 3],
        lambda seen, limits: limits.config.joint_speed_limit[
            _first_above(seen.motion.speed, limits.config.joint_speed_limit) % 3
        ],
    ),
    Rule(
        tip_slow,
        TripCause.TIP_SPEED,
        lambda seen, _: seen.motion.tip_speed_m_per_s,
        lambda _, limits: limits.config.tip_speed_limit_m_per_s,
    ),
)
