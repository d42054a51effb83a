"""What must hold of the joints, the tip and the valves that move them."""

from hydrohil.services.supervisor.rule import Limits, Observed, Rule
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import TripCause
from hydrohil.shared.machine.description import Triple

# The kernels named `_first_...` return the index that a rule judges: of the first value that breaks its limit, 0 if none does.


@kernel
def counters_connected(observed: Observed, limits: Limits) -> bool:
    return _connected(observed.motion.counts, limits, _first_disconnected(observed.motion.counts, limits))


@kernel
def counters_follow(observed: Observed, limits: Limits) -> bool:
    return _follows(observed, limits, _first_jump(observed, limits))


@kernel
def links_obey(observed: Observed, limits: Limits) -> bool:
    against, brakes_q = observed.motion.against, limits.motion.brakes_q
    return _below(against, brakes_q, _first_above(against, brakes_q))


@kernel
def links_move(observed: Observed, limits: Limits) -> bool:
    for link in range(3):
        if not observed.motion.idle_ns[link] <= limits.motion.moves_within_ns:
            return False
    return True


@kernel
def joints_within(observed: Observed, limits: Limits) -> bool:
    low, high = limits.config.joint_low_q, limits.config.joint_high_q
    return _inside(observed.motion.q, low, high, _first_outside(observed.motion.q, low, high))


@kernel
def tip_within(observed: Observed, limits: Limits) -> bool:
    low, high = limits.config.workspace_low_m, limits.config.workspace_high_m
    return _inside(observed.motion.tip_m, low, high, _first_outside(observed.motion.tip_m, low, high))


@kernel
def joints_slow(observed: Observed, limits: Limits) -> bool:
    most = limits.config.joint_speed_limit_q_per_s
    return _below(observed.motion.speed, most, _first_above(observed.motion.speed, most))


@kernel
def tip_slow(observed: Observed, limits: Limits) -> bool:
    return observed.motion.tip_speed_m_per_s <= limits.config.tip_speed_limit_m_per_s


@kernel
def _connected(counts: tuple[int, int, int], limits: Limits, link: int) -> bool:
    """Whether a counter stands between its ends."""
    return limits.low_counts[link] < counts[link] < limits.high_counts[link]


@kernel
def _first_disconnected(counts: tuple[int, int, int], limits: Limits) -> int:
    for link in range(3):
        if not _connected(counts, limits, link):
            return link
    return 0


@kernel
def _counter_end(counts: tuple[int, int, int], limits: Limits) -> int:
    """The end at or beyond which the counter that is judged stands."""
    link = _first_disconnected(counts, limits)
    return limits.low_counts[link] if counts[link] <= limits.low_counts[link] else limits.high_counts[link]


@kernel
def _reach(observed: Observed, limits: Limits, encoder: int) -> float:
    """Furthest that an encoder can have moved since the sample before: at full speed, and the count that a floor may add."""
    return limits.motion.full_speed[encoder] * observed.motion.dt_s + limits.count_q[encoder] * (1.0 + 1e-9)


@kernel
def _follows(observed: Observed, limits: Limits, encoder: int) -> bool:
    """Whether an encoder moved no further than it can."""
    return abs(observed.motion.moved_q[encoder]) <= _reach(observed, limits, encoder)


@kernel
def _first_jump(observed: Observed, limits: Limits) -> int:
    """Of the four encoders; the fourth is the hand's pitch."""
    for encoder in range(4):
        if not _follows(observed, limits, encoder):
            return encoder
    return 0


@kernel
def _below(values: Triple, most: Triple, i: int) -> bool:
    return abs(values[i]) <= most[i]


@kernel
def _first_above(values: Triple, most: Triple) -> int:
    for i in range(3):
        if not _below(values, most, i):
            return i
    return 0


@kernel
def _inside(values: Triple, low: Triple, high: Triple, i: int) -> bool:
    return low[i] <= values[i] <= high[i]


@kernel
def _first_outside(values: Triple, low: Triple, high: Triple) -> int:
    for i in range(3):
        if not _inside(values, low, high, i):
            return i
    return 0


@kernel
def _bound_broken(values: Triple, low: Triple, high: Triple) -> float:
    """The bound that the value that is judged breaks, the lower one for a NaN; the upper one if it is inside."""
    i = _first_outside(values, low, high)
    return high[i] if values[i] > high[i] or _inside(values, low, high, i) else low[i]


@kernel
def _longest_idle_ns(observed: Observed) -> int:
    """For how long the link that has been idle for longest has not moved, in ns."""
    idle = observed.motion.idle_ns
    return max(idle[0], idle[1], idle[2])


MOTION_RULES = (
    Rule(
        holds=counters_connected,
        cause=TripCause.ENCODER_INVALID,
        measured=lambda observed, limits: float(observed.motion.counts[_first_disconnected(observed.motion.counts, limits)]),
        limit=lambda observed, limits: float(_counter_end(observed.motion.counts, limits)),
    ),
    Rule(
        holds=counters_follow,
        cause=TripCause.ENCODER_JUMP,
        measured=lambda observed, limits: observed.motion.moved_q[_first_jump(observed, limits)],
        limit=lambda observed, limits: _reach(observed, limits, _first_jump(observed, limits)),
    ),
    Rule(
        holds=links_obey,
        cause=TripCause.MOTION_AGAINST,
        measured=lambda observed, limits: observed.motion.against[_first_above(observed.motion.against, limits.motion.brakes_q)],
        limit=lambda observed, limits: limits.motion.brakes_q[_first_above(observed.motion.against, limits.motion.brakes_q)],
    ),
    Rule(
        holds=links_move,
        cause=TripCause.NO_MOTION,
        measured=lambda observed, _: _longest_idle_ns(observed) * 1e-9,
        limit=lambda _, limits: limits.motion.moves_within_ns * 1e-9,
    ),
    Rule(
        holds=joints_within,
        cause=TripCause.JOINT_LIMIT,
        measured=lambda observed, limits: observed.motion.q[
            _first_outside(observed.motion.q, limits.config.joint_low_q, limits.config.joint_high_q)
        ],
        limit=lambda observed, limits: _bound_broken(observed.motion.q, limits.config.joint_low_q, limits.config.joint_high_q),
    ),
    Rule(
        holds=tip_within,
        cause=TripCause.WORKSPACE,
        measured=lambda observed, limits: observed.motion.tip_m[
            _first_outside(observed.motion.tip_m, limits.config.workspace_low_m, limits.config.workspace_high_m)
        ],
        limit=lambda observed, limits: _bound_broken(
            observed.motion.tip_m, limits.config.workspace_low_m, limits.config.workspace_high_m
        ),
    ),
    Rule(
        holds=joints_slow,
        cause=TripCause.JOINT_SPEED,
        measured=lambda observed, limits: observed.motion.speed[
            _first_above(observed.motion.speed, limits.config.joint_speed_limit_q_per_s)
        ],
        limit=lambda observed, limits: limits.config.joint_speed_limit_q_per_s[
            _first_above(observed.motion.speed, limits.config.joint_speed_limit_q_per_s)
        ],
    ),
    Rule(
        holds=tip_slow,
        cause=TripCause.TIP_SPEED,
        measured=lambda observed, _: observed.motion.tip_speed_m_per_s,
        limit=lambda _, limits: limits.config.tip_speed_limit_m_per_s,
    ),
)
