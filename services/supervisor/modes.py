"""The mode machine: DISARMED, ARMED, RUNNING, TRIPPED, RECOVER. Pure; a trip latches, and a reset moves nothing."""

from enum import IntEnum
from typing import NamedTuple

from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import Mode

DISARMED, ARMED, RUNNING, TRIPPED, RECOVER = map(int, Mode)


class Event(IntEnum):
    """What an operator may ask."""

    NOTHING = 0
    ARM = 1
    START = 2
    STOP = 3
    ESTOP = 4
    RESET = 5
    HOLD_RECOVER = 6  # hold to run, with a lease of its own
    RELEASE = 7


NOTHING, ARM, START, STOP, ESTOP, RESET, HOLD_RECOVER, RELEASE = map(int, Event)


class Facts(NamedTuple):
    """What a change of mode depends on besides the event."""

    broken: int  # cause of the first rule that does not hold
    estop: bool
    may_arm: bool  # limits stand below the gate's, all services agree on experiment and run
    can_recover: bool  # the cause has a direction that unloads, nothing worse is on top of it, no emergency stop is pressed
    held: bool  # the lease of HOLD_RECOVER has not run out
    finished: bool  # the trial's declared duration is over
    armed_too_long: bool


@kernel
def next_mode(mode: int, event: int, facts: Facts) -> int:
    """Mode after one step. A mode that permits motion ends where what it needs is absent; TRIPPED by a reset or RECOVER."""
    if facts.estop or event == ESTOP:
        return TRIPPED
    if mode == RUNNING:
        return _from_running(event, facts)
    if mode == ARMED:
        return _from_armed(event, facts)
    if mode == TRIPPED:
        if event == RESET and facts.broken == 0:
            return DISARMED
        return RECOVER if event == HOLD_RECOVER and facts.can_recover else TRIPPED
    if mode == RECOVER:
        holds = event in (NOTHING, HOLD_RECOVER)
        return RECOVER if holds and facts.held and facts.can_recover else TRIPPED
    return ARMED if event == ARM and facts.broken == 0 and facts.may_arm else DISARMED


@kernel
def _from_running(event: int, facts: Facts) -> int:
    if facts.broken != 0:
        return TRIPPED
    return DISARMED if event == STOP or facts.finished else RUNNING


@kernel
def _from_armed(event: int, facts: Facts) -> int:
    if facts.broken != 0 or event == STOP or facts.armed_too_long or not facts.may_arm:
        return DISARMED
    return RUNNING if event == START else ARMED
