"""The gate between bus and D/A: zero current unless every condition for motion holds. Nothing overrules it.

It is shut at boot, it shuts when a permit or a command stops coming, and it never opens again on an arming that a cut has
revoked. Every condition states what must hold, so that a NaN shuts it.
"""

from typing import NamedTuple

from hydrohil.services.plant.config import GateLimits
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.messages import NO_COMMAND, GateCause, GateState, LinkCounts, Mode

SHUT = int(GateState.SHUT)
OPEN = int(GateState.OPEN)
REVOKED = int(GateState.REVOKED)
RECOVERING = int(GateState.RECOVERING)
NONE = int(GateCause.NONE)
NO_PERMIT = int(GateCause.NO_PERMIT)
NOT_RUNNING = int(GateCause.NOT_RUNNING)
REVOKED_ARMING = int(GateCause.REVOKED_ARMING)
PERMIT_STALE = int(GateCause.PERMIT_STALE)
COMMAND_MISSING = int(GateCause.NO_COMMAND)
COMMAND_STALE = int(GateCause.COMMAND_STALE)
OTHER_ARMING = int(GateCause.OTHER_ARMING)
EPOCH_CHANGED = int(GateCause.EPOCH_CHANGED)
IMPOSSIBLE_ECHO = int(GateCause.IMPOSSIBLE_ECHO)
OUT_OF_RANGE = int(GateCause.OUT_OF_RANGE)
BEYOND_SLEW = int(GateCause.BEYOND_SLEW)
FORCE_INVALID = int(GateCause.FORCE_INVALID)
FORCE_ABOVE_LIMIT = int(GateCause.FORCE_ABOVE_LIMIT)
NOT_UNLOADING = int(GateCause.NOT_UNLOADING)
ESTOP = int(GateCause.ESTOP)
OVERRUN = int(GateCause.OVERRUN)
LINK_FAULTS = int(GateCause.LINK_FAULTS)
TWO_PUBLISHERS = int(GateCause.TWO_PUBLISHERS)
_RUNNING, _RECOVER = int(Mode.RUNNING), int(Mode.RECOVER)
_ZERO = (ZERO_CODE, ZERO_CODE, ZERO_CODE)
_NO_SIGNS = (0, 0, 0)
RevokedIds = tuple[int, int, int, int, int, int, int, int, int, int, int, int, int, int, int, int]  # the last 16, newest first
_NONE_REVOKED: RevokedIds = (0,) * 16


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
    overrun: bool  # the plant itself was delayed by more than the lease
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
    revoked: RevokedIds = _NONE_REVOKED
    recover_signs: LinkCounts = _NO_SIGNS


NO_PERMIT_OBSERVATION = PermitObservation(present=False, arming_id=0, epoch=0, mode=0, age_ns=-1, recover_signs=_NO_SIGNS)
NO_COMMAND_OBSERVATION = CommandObservation(present=False, arming_id=0, epoch=0, age_ns=-1, number=NO_COMMAND, codes=_ZERO)


@kernel
def gate_step(memory: GateMemory, limits: GateLimits, observed: GateInput, at_latch: bool) -> GateMemory:
    """Judge permit, command and force; `at_latch` marks the regular instant, once a sample."""
    cause = _broken(memory, limits, observed)
    if cause != NONE:
        return _cut(memory, observed, cause)
    recovering = observed.permit.mode == _RECOVER
    samples = memory.open_samples + 1 if at_latch else memory.open_samples
    return GateMemory(
        state=RECOVERING if recovering else OPEN,
        cause=NONE,
        codes=observed.command.codes,
        command_number=observed.command.number,
        open_samples=samples,
        arming_id=observed.permit.arming_id,
        permit_epoch=observed.permit.epoch,
        command_epoch=observed.command.epoch,
        revoked=memory.revoked,
        recover_signs=observed.permit.recover_signs if recovering else _NO_SIGNS,
    )


@kernel
def _cut(memory: GateMemory, observed: GateInput, cause: int) -> GateMemory:
    """Zero current. What was bound is revoked; while shut, an impossible echo or a worse cause revokes the permit's arming."""
    arming_id, revoked = observed.permit.arming_id, memory.revoked
    if not (memory.state == SHUT or memory.state == REVOKED):
        revoked = (memory.arming_id,) + revoked[:-1]
    elif cause >= IMPOSSIBLE_ECHO and arming_id != 0 and not _is_revoked(revoked, arming_id):
        revoked = (arming_id,) + revoked[:-1]
    return GateMemory(
        state=REVOKED if observed.permit.present and _is_revoked(revoked, arming_id) else SHUT,
        cause=cause,
        codes=_ZERO,
        command_number=observed.command.number,
        open_samples=0,
        arming_id=0,
        permit_epoch=0,
        command_epoch=0,
        revoked=revoked,
        recover_signs=_NO_SIGNS,
    )


@kernel
def _is_revoked(revoked: tuple[int, ...], arming_id: int) -> bool:
    for one in revoked:
        if one == arming_id and arming_id != 0:
            return True
    return False


@kernel
def _broken(memory: GateMemory, limits: GateLimits, observed: GateInput) -> int:
    """The first condition that does not hold."""
    if observed.estop:
        return ESTOP
    if observed.overrun:
        return OVERRUN
    if not observed.link_faults <= limits.faults_per_s:
        return LINK_FAULTS
    if not observed.epoch_conflicts <= limits.faults_per_s:
        return TWO_PUBLISHERS
    cause = _permit_broken(memory, limits, observed)
    if cause == NONE:
        cause = _command_broken(memory, limits, observed)
    if cause == NONE and observed.permit.mode == _RUNNING:
        cause = _force_broken(limits, observed)
    return cause


@kernel
def _permit_broken(memory: GateMemory, limits: GateLimits, observed: GateInput) -> int:
    permit = observed.permit
    if not permit.present or permit.arming_id == 0:
        return NO_PERMIT
    if _is_revoked(memory.revoked, permit.arming_id):
        return REVOKED_ARMING
    if not permit.age_ns >= 0:
        return IMPOSSIBLE_ECHO
    if not permit.age_ns <= limits.permit_ttl_ns:
        return PERMIT_STALE
    running = permit.mode == _RUNNING and observed.tick >= 0
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
def _command_broken(memory: GateMemory, limits: GateLimits, observed: GateInput) -> int:
    command = observed.command
    if not command.present:
        return COMMAND_MISSING
    if not command.age_ns >= 0:
        return IMPOSSIBLE_ECHO
    if not command.age_ns <= limits.command_ttl_ns:
        return COMMAND_STALE
    if command.arming_id != observed.permit.arming_id:
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
        if observed.permit.mode == _RECOVER:
            away = (code - ZERO_CODE) * observed.permit.recover_signs[link]
            if not (code == ZERO_CODE or 0 < away <= limits.recover_codes):
                return NOT_UNLOADING
    return NONE


@kernel
def slew_codes(memory: GateMemory, limits: GateLimits) -> int:
    """Largest step of a code: tight for the first samples after the gate opens."""
    return limits.tight_slew_codes if memory.open_samples < limits.tight_samples else limits.slew_codes


@kernel
def _force_broken(limits: GateLimits, observed: GateInput) -> int:
    if not limits.min_force_counts <= observed.force_counts < limits.max_force_counts:
        return FORCE_INVALID
    if not abs(observed.force_n) <= limits.force_limit_n:
        return FORCE_ABOVE_LIMIT
    return NONE
