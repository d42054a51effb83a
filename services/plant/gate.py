"""The gate between bus and D/A: zero current unless everything that permits motion holds. It has the last word.

It is silent at boot, loses permission by absence, and never opens again on an arming that a cut has revoked.
Every condition states what must hold, so that an unknown value shuts.
"""

from typing import NamedTuple

from hydrohil.services.plant.config import GateLimits
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.messages import NO_COMMAND, GateCause, GateState, LinkCounts, Mode

SHUT, OPEN, REVOKED, RECOVERING = map(int, GateState)
(
    NONE,
    NO_PERMIT,
    NOT_RUNNING,
    REVOKED_ARMING,
    PERMIT_STALE,
    COMMAND_MISSING,
    COMMAND_STALE,
    OTHER_ARMING,
    EPOCH_CHANGED,
    IMPOSSIBLE_ECHO,
    OUT_OF_RANGE,
    BEYOND_SLEW,
    FORCE_INVALID,
    FORCE_ABOVE_LIMIT,
    NOT_UNLOADING,
    ESTOP,
    OVERRUN,
    LINK_FAULTS,
    TWO_PUBLISHERS,
) = map(int, GateCause)
_RUNNING, _RECOVER = int(Mode.RUNNING), int(Mode.RECOVER)
_ZERO = (ZERO_CODE, ZERO_CODE, ZERO_CODE)
_NO_SIGNS = (0, 0, 0)
_NO_ARMING_IDS = (0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)


class PermitObservation(NamedTuple):
    """The newest valid permit; age by its echo, -1 if the echo names no sample of this plant."""

    present: bool
    arming_id: int
    epoch: int
    mode: int
    age_ns: int
    recover_signs: LinkCounts


class CommandObservation(NamedTuple):
    """The newest valid command; age by its echo, -1 if the echo names no sample of this plant."""

    present: bool
    arming_id: int
    epoch: int
    age_ns: int
    number: int
    codes: LinkCounts


class GateInput(NamedTuple):
    """What the gate judges at one instant."""

    permit: PermitObservation
    command: CommandObservation
    force_counts: int
    force_n: float
    tick: int  # of the sample that is being answered
    estop: bool
    overrun: bool  # the plant itself stood still for longer than the lease
    link_faults: int  # CRC and sequence faults of the last second under a bound identity, of the worse link
    epoch_conflicts: int  # frames of the last second by which a bound sender has another epoch, of the worse link


class GateMemory(NamedTuple):
    """State of the gate; `codes` is what stands at the D/A."""

    state: int = SHUT
    cause: int = NO_PERMIT
    codes: LinkCounts = _ZERO
    command_number: int = NO_COMMAND
    open_samples: int = 0
    arming_id: int = 0  # bound while open
    permit_epoch: int = 0
    command_epoch: int = 0
    revoked: tuple[int, int, int, int, int, int, int, int, int, int, int, int, int, int, int, int] = _NO_ARMING_IDS  # the last 16
    recover_signs: LinkCounts = _NO_SIGNS


NO_PERMIT_OBSERVATION = PermitObservation(False, 0, 0, 0, -1, _NO_SIGNS)
NO_COMMAND_OBSERVATION = CommandObservation(False, 0, 0, -1, NO_COMMAND, _ZERO)


@kernel
def gate_step(memory: GateMemory, limits: GateLimits, seen: GateInput, at_latch: bool) -> GateMemory:
    """Judge permit, command and force; `at_latch` marks the regular instant, once a sample."""
    cause = _broken(memory, limits, seen)
    shut = memory.state == SHUT or memory.state == REVOKED
    if cause != NONE:
        revoked = memory.revoked
        if not shut:
            revoked = (memory.arming_id,) + revoked[:-1]
        elif cause >= IMPOSSIBLE_ECHO and seen.permit.arming_id != 0 and not _is_revoked(revoked, seen.permit.arming_id):
            revoked = (seen.permit.arming_id,) + revoked[:-1]
        state = REVOKED if seen.permit.present and _is_revoked(revoked, seen.permit.arming_id) else SHUT
        return GateMemory(state, cause, _ZERO, seen.command.number, 0, 0, 0, 0, revoked, _NO_SIGNS)
    recovering = seen.permit.mode == _RECOVER
    samples = memory.open_samples + 1 if at_latch else memory.open_samples
    return GateMemory(
        RECOVERING if recovering else OPEN,
        NONE,
        seen.command.codes,
        seen.command.number,
        samples,
        seen.permit.arming_id,
        seen.permit.epoch,
        seen.command.epoch,
        memory.revoked,
        seen.permit.recover_signs if recovering else _NO_SIGNS,
    )


@kernel
def _is_revoked(revoked: tuple[int, ...], arming_id: int) -> bool:
    for number in revoked:
        if number == arming_id and arming_id != 0:
            return True
    return False


@kernel
def _broken(memory: GateMemory, limits: GateLimits, seen: GateInput) -> int:
    """The first condition that does not hold."""
    if seen.estop:
        return ESTOP
    if seen.overrun:
        return OVERRUN
    if not seen.link_faults <= limits.faults_per_s:
        return LINK_FAULTS
    if not seen.epoch_conflicts <= limits.faults_per_s:
        return TWO_PUBLISHERS
    cause = _permit_broken(memory, limits, seen)
    if cause == NONE:
        cause = _command_broken(memory, limits, seen)
    if cause == NONE and seen.permit.mode == _RUNNING:
        cause = _force_broken(limits, seen)
    return cause


@kernel
def _permit_broken(memory: GateMemory, limits: GateLimits, seen: GateInput) -> int:
    permit = seen.permit
    if not permit.present or permit.arming_id == 0:
        return NO_PERMIT
    if _is_revoked(memory.revoked, permit.arming_id):
        return REVOKED_ARMING
    if not permit.age_ns >= 0:
        return IMPOSSIBLE_ECHO
    if not permit.age_ns <= limits.permit_ttl_ns:
        return PERMIT_STALE
    running = permit.mode == _RUNNING and seen.tick >= 0
    if not (running or permit.mode == _RECOVER):
        return NOT_RUNNING
    if memory.arming_id != 0 and (
        permit.arming_id != memory.arming_id or (permit.mode == _RECOVER) != (memory.state == RECOVERING)
    ):
        return OTHER_ARMING
    if memory.arming_id != 0 and permit.epoch != memory.permit_epoch:
        return EPOCH_CHANGED
    return NONE


@kernel
def _command_broken(memory: GateMemory, limits: GateLimits, seen: GateInput) -> int:
    command = seen.command
    if not command.present:
        return COMMAND_MISSING
    if not command.age_ns >= 0:
        return IMPOSSIBLE_ECHO
    if not command.age_ns <= limits.command_ttl_ns:
        return COMMAND_STALE
    if command.arming_id != seen.permit.arming_id:
        return OTHER_ARMING
    if memory.arming_id != 0 and command.epoch != memory.command_epoch:
        return EPOCH_CHANGED
    slew = slew_codes(memory, limits)
    for link in range(3):
        code = command.codes[link]
        if not limits.min_code <= code <= limits.max_code:
            return OUT_OF_RANGE
        if not abs(code - memory.codes[link]) <= slew:
            return BEYOND_SLEW
        if seen.permit.mode == _RECOVER:
            away = (code - ZERO_CODE) * seen.permit.recover_signs[link]
            if not (code == ZERO_CODE or 0 < away <= limits.recover_codes):
                return NOT_UNLOADING
    return NONE


@kernel
def slew_codes(memory: GateMemory, limits: GateLimits) -> int:
    """Largest step of a code: tight for the first samples after the gate opens."""
    return limits.tight_slew_codes if memory.open_samples < limits.tight_samples else limits.slew_codes


@kernel
def _force_broken(limits: GateLimits, seen: GateInput) -> int:
    if not limits.min_force_counts <= seen.force_counts < limits.max_force_counts:
        return FORCE_INVALID
    if not abs(seen.force_n) <= limits.force_limit_n:
        return FORCE_ABOVE_LIMIT
    return NONE
