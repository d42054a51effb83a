"""What must hold of the joints, the tip and the valves that move them."""

from services.supervisor.rule import Limits, Observed, Rule
from shared.kernel import kernel
from shared.messages import TripCause
from shared.pose import Triple


@kernel
def joints_within(seen: Observed, limits: Limits) -> bool:
    for link in range(3):
        if not limits.config.joint_low_rad[link] <= seen.motion.q_rad[link] <= limits.config.joint_high_rad[link]:
            return False
    return True


@kernel
def tip_within(seen: Observed, limits: Limits) -> bool:
    for axis in range(3):
        if not limits.config.workspace_low_m[axis] <= seen.motion.tip_m[axis] <= limits.config.workspace_high_m[axis]:
            return False
    return True


@kernel
def _worst(values: Triple, low: Triple, high: Triple) -> tuple[float, float]:
    """The first value outside its bounds and the bound it broke."""
    for i in range(3):
        if not low[i] <= values[i] <= high[i]:
            return values[i], high[i] if values[i] > high[i] else low[i]
    return values[0], high[0]


MOTION_RULES = (
    Rule(
        joints_within,
        TripCause.JOINT_LIMIT,
        lambda seen, limits: _worst(seen.motion.q_rad, limits.config.joint_low_rad, limits.config.joint_high_rad)[0],
        lambda seen, limits: _worst(seen.motion.q_rad, limits.config.joint_low_rad, limits.config.joint_high_rad)[1],
        "a joint is beyond its limit (rad; link 3 m)",
    ),
    Rule(
        tip_within,
        TripCause.WORKSPACE,
        lambda seen, limits: _worst(seen.motion.tip_m, limits.config.workspace_low_m, limits.config.workspace_high_m)[0],
        lambda seen, limits: _worst(seen.motion.tip_m, limits.config.workspace_low_m, limits.config.workspace_high_m)[1],
        "the tip has left its workspace (m)",
    ),
)
