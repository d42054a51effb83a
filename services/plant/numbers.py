"""The numbers behind a decision of the gate: what was measured, and the limit that it broke."""

from services.plant.config import GateLimits
from services.plant.gate import GateInput, GateMemory, slew_codes
from shared.converters import ZERO_CODE
from shared.messages import GateCause
from shared.units import NS_PER_S


def numbers(cause: int, before: GateMemory, seen: GateInput, limits: GateLimits) -> tuple[float, float]:
    """Measured value and limit; zeros where there is no number. `before` is the gate as it stood when it judged `seen`."""
    known = {
        GateCause.PERMIT_STALE: (seen.permit.age_ns / NS_PER_S, limits.permit_ttl_ns / NS_PER_S),
        GateCause.COMMAND_STALE: (seen.command.age_ns / NS_PER_S, limits.command_ttl_ns / NS_PER_S),
        GateCause.OUT_OF_RANGE: _range(seen, limits),
        GateCause.BEYOND_SLEW: _slew(before, seen, limits),
        GateCause.FORCE_INVALID: _reading(seen, limits),
        GateCause.FORCE_ABOVE_LIMIT: (seen.force_n, limits.force_limit_n),
        GateCause.NOT_UNLOADING: _unloading(seen, limits),
        GateCause.LINK_FAULTS: (float(seen.link_faults), float(limits.faults_per_s)),
        GateCause.TWO_PUBLISHERS: (float(seen.rivals), float(limits.faults_per_s)),
    }
    return known.get(GateCause(cause), (0.0, 0.0))


def _range(seen: GateInput, limits: GateLimits) -> tuple[float, float]:
    """The first code outside the converter's range, and the end that it is beyond."""
    for code in seen.command.codes:
        if not limits.min_code <= code <= limits.max_code:
            return float(code), float(limits.min_code if code < limits.min_code else limits.max_code)
    return 0.0, 0.0


def _slew(before: GateMemory, seen: GateInput, limits: GateLimits) -> tuple[float, float]:
    """The largest step of a code, and the limit at that moment."""
    steps = [abs(code - stood) for code, stood in zip(seen.command.codes, before.codes, strict=True)]
    return float(max(steps)), float(slew_codes(before, limits))


def _reading(seen: GateInput, limits: GateLimits) -> tuple[float, float]:
    low = seen.force_counts < limits.min_force_counts
    return float(seen.force_counts), float(limits.min_force_counts if low else limits.max_force_counts)


def _unloading(seen: GateInput, limits: GateLimits) -> tuple[float, float]:
    """The first code that does not unload, and the end that it is beyond: zero current, or the largest that is allowed."""
    for code, sign in zip(seen.command.codes, seen.permit.recover_signs, strict=True):
        away = (code - ZERO_CODE) * sign
        if code != ZERO_CODE and not 0 < away <= limits.recover_codes:
            return float(code), float(ZERO_CODE + (sign * limits.recover_codes if away > 0 else 0))
    return 0.0, 0.0
