"""The gate's conditions as inputs: what the gate reads from permit, command and force, and how each condition is broken."""

from collections.abc import Callable, Iterable
from typing import Any

from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.gate import CommandObservation, GateInput, GateMemory, PermitObservation
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.messages import GateCause, Mode

LIMITS = GateLimits(slew_codes=GateLimits().tight_slew_codes)
ZERO = (ZERO_CODE, ZERO_CODE, ZERO_CODE)
_STEP_CODES = 12  # of the down/up valve, within the tight slew limit
_LOADING, _UNLOADING = (ZERO_CODE, ZERO_CODE + _STEP_CODES, ZERO_CODE), (ZERO_CODE, ZERO_CODE - _STEP_CODES, ZERO_CODE)
_UNLOADING_SIGNS = (0, -1, 0)
_SUPERVISOR_EPOCH, _CONTROLLER_EPOCH = 1, 2
_AGE_NS = 4_000_000
_FORCE_COUNTS, _FORCE_N = 10, 13.5

Break = Callable[[GateInput, GateMemory], GateInput]


def _permit(**changes: Any) -> Break:
    return lambda given, _: given._replace(permit=given.permit._replace(**changes))


def _command(**changes: Any) -> Break:
    return lambda given, _: given._replace(command=given.command._replace(**changes))


def _too_far(given: GateInput, gate: GateMemory) -> GateInput:
    step = LIMITS.slew_codes + 1
    sign = -1 if given.permit.mode == Mode.RECOVER else 1
    codes = gate.codes[0], gate.codes[1] + sign * step, gate.codes[2]
    return given._replace(command=given.command._replace(codes=codes))


CONDITIONS: dict[GateCause, Break] = {  # the gate's input when a condition is broken
    GateCause.NO_PERMIT: _permit(present=False),
    GateCause.NOT_RUNNING: lambda given, _: given._replace(tick=-1),
    GateCause.PERMIT_STALE: _permit(age_ns=LIMITS.permit_ttl_ns + 1),
    GateCause.NO_COMMAND: _command(present=False),
    GateCause.COMMAND_STALE: _command(age_ns=LIMITS.command_ttl_ns + 1),
    GateCause.OTHER_ARMING: lambda given, _: given._replace(
        command=given.command._replace(arming_id=given.command.arming_id + 1)
    ),
    GateCause.EPOCH_CHANGED: _command(epoch=_CONTROLLER_EPOCH + 1),
    GateCause.IMPOSSIBLE_ECHO: _command(age_ns=-1),
    GateCause.OUT_OF_RANGE: _command(codes=(ZERO_CODE, LIMITS.max_code + 1, ZERO_CODE)),
    GateCause.BEYOND_SLEW: _too_far,
    GateCause.FORCE_INVALID: lambda given, _: given._replace(force_counts=LIMITS.max_force_counts),
    GateCause.FORCE_ABOVE_LIMIT: lambda given, _: given._replace(force_n=LIMITS.force_limit_n + 1.0),
    GateCause.NOT_UNLOADING: _command(codes=_LOADING),
    GateCause.ESTOP: lambda given, _: given._replace(estop=True),
    GateCause.OVERRUN: lambda given, _: given._replace(overrun=True),
    GateCause.LINK_FAULTS: lambda given, _: given._replace(link_faults=LIMITS.faults_per_s + 1),
    GateCause.TWO_PUBLISHERS: lambda given, _: given._replace(epoch_conflicts=LIMITS.faults_per_s + 1),
}


def gate_input(mode: Mode, arming_id: int, gate: GateMemory, broken: Iterable[GateCause]) -> GateInput:
    """What the gate judges in `mode` under an arming, with the conditions `broken`; codes and counts as the gate has them."""
    recovers = mode == Mode.RECOVER
    given = GateInput(
        permit=PermitObservation(
            present=True,
            arming_id=arming_id,
            epoch=_SUPERVISOR_EPOCH,
            mode=int(mode),
            age_ns=_AGE_NS,
            recover_signs=_UNLOADING_SIGNS if recovers else (0, 0, 0),
        ),
        command=CommandObservation(
            present=True,
            arming_id=arming_id,
            epoch=_CONTROLLER_EPOCH,
            age_ns=_AGE_NS,
            number=0,
            codes=_UNLOADING if recovers else _LOADING,
        ),
        force_counts=_FORCE_COUNTS,
        force_n=_FORCE_N,
        tick=0,
        estop=False,
        overrun=False,
        link_faults=0,
        epoch_conflicts=0,
    )
    for cause in sorted(broken):
        given = CONDITIONS[cause](given, gate)
    return given
