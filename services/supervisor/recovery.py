"""Recovery after a trip: which way unloads the violated quantity, and when another cause forbids or redirects it."""

import math

from hydrohil.services.supervisor.modes import RECOVER
from hydrohil.services.supervisor.rule import Observed
from hydrohil.services.supervisor.state import NO_SIGNS, SupervisorMemory, SupervisorParams
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import TripCause

_ESTOP, _LAST_OF_FORCE, _JOINT_LIMIT = int(TripCause.ESTOP), int(TripCause.FORCE_BELOW_BIAS), int(TripCause.JOINT_LIMIT)
_AXIS_Z = 2


@kernel
def can_recover(memory: SupervisorMemory, params: SupervisorParams, observed: Observed, broken: int) -> bool:
    """Whether recovery may begin or go on, with `broken` the cause of the first rule that does not hold (0 = none)."""
    if memory.pressed:
        return False
    if memory.mode == RECOVER:
        return not trips_recovery(memory, params, observed, broken)
    return _unloads(memory.recover_signs) or _unloads(unloading_signs(params, observed, broken))


@kernel
def redirects(memory: SupervisorMemory, params: SupervisorParams, observed: Observed, broken: int) -> bool:
    """Whether what is broken now unloads another way than the latched cause: a joint limit may outlast the force."""
    now = unloading_signs(params, observed, broken)
    return _unloads(now) and now != memory.recover_signs


@kernel
def trips_recovery(memory: SupervisorMemory, params: SupervisorParams, observed: Observed, broken: int) -> bool:
    """Whether recovery has met another cause, more severe or of another direction. All causes of force count as one."""
    if broken == 0 or broken == memory.cause:
        return False
    return redirects(memory, params, observed, broken) or memory.cause > max(broken, _LAST_OF_FORCE)


@kernel
def unloading_signs(params: SupervisorParams, observed: Observed, cause: int) -> tuple[int, int, int]:
    """Sign per link that lowers the violated quantity; zeros where there is none.

    A gauge that is not believed has one too: away from the environment is geometry, and the operator holds it by hand.
    A force along z is unloaded by link 2 (positive down), one along x by link 3 (positive out).
    """
    if _ESTOP <= cause <= _LAST_OF_FORCE:
        away = int(math.copysign(1.0, params.observer.force_sign))
        return (0, -away, 0) if params.observer.force_axis == _AXIS_Z else (0, 0, away)
    if cause == _JOINT_LIMIT:
        config = params.limits.config
        return (
            _inward(observed.motion.q[0], config.joint_low_q[0], config.joint_high_q[0]),
            _inward(observed.motion.q[1], config.joint_low_q[1], config.joint_high_q[1]),
            _inward(observed.motion.q[2], config.joint_low_q[2], config.joint_high_q[2]),
        )
    return NO_SIGNS


@kernel
def _unloads(signs: tuple[int, int, int]) -> bool:
    """Whether there is a way at all."""
    return signs[0] != 0 or signs[1] != 0 or signs[2] != 0


@kernel
def _inward(q: float, low_q: float, high_q: float) -> int:
    if q < low_q:
        return 1
    return -1 if q > high_q else 0
