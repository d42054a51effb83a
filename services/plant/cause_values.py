"""The numbers behind a decision of the gate: what was measured, and the limit that it broke."""

from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.gate import GateInput, GateMemory, slew_codes
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.messages import GateCause
from hydrohil.shared.units import NS_PER_S


def cause_values(cause: int, before: GateMemory, observed: GateInput, limits: GateLimits) -> tuple[float, float]:
    """Measured value and limit; zeros where there is no number. `before` is the gate as it stood when it judged `observed`."""
    known = {
        GateCause.PERMIT_STALE: (observed.permit.age_ns / NS_PER_S, limits.permit_ttl_ns / NS_PER_S),
        GateCause.COMMAND_STALE: (observed.command.age_ns / NS_PER_S, limits.command_ttl_ns / NS_PER_S),
        GateCause.OUT_OF_RANGE: _range(observed, limits),
        GateCause.BEYOND_SLEW: _slew(before, observed, limits),
        GateCause.FORCE_INVALID: _reading(observed, limits),
        GateCause.FORCE_ABOVE_LIMIT: (observed.force_n, limits.force_limit_n),
        GateCause.NOT_UNLOADING: _unloading(observed, limits),
        GateCause.LINK_FAULTS: (float(observed.link_faults), float(limits.faults_per_s)),
        GateCause.TWO_PUBLISHERS: (float(observed.epoch_conflicts), float(limits.faults_per_s)),
    }
    return known.get(GateCause(cause), (0.0, 0.0))


def _range(observed: GateInput, limits: GateLimits) -> tuple[float, float]:
    """The first code outside the converter's range, and the end that it is beyond."""
    for code in observed.command.codes:
        end = max(limits.min_code, min(code, limits.max_code))
        if code != end:
            return float(code), float(end)
    return 0.0, 0.0


def _slew(before: GateMemory, observed: GateInput, limits: GateLimits) -> tuple[float, float]:
    """The largest step of a code, and the limit at that moment."""
    step = max(abs(observed.command.codes[link] - before.codes[link]) for link in range(3))
    return float(step), float(slew_codes(before, limits))


def _reading(observed: GateInput, limits: GateLimits) -> tuple[float, float]:
    low = observed.force_counts < limits.min_force_counts
    return float(observed.force_counts), float(limits.min_force_counts if low else limits.max_force_counts)


def _unloading(observed: GateInput, limits: GateLimits) -> tuple[float, float]:
    """The first code that does not unload, and the end that it is beyond: zero current, or the largest that is allowed."""
    for link in range(3):
        code, sign = observed.command.codes[link], observed.permit.recover_signs[link]
        end = ZERO_CODE + sign * max(0, min((code - ZERO_CODE) * sign, limits.recover_codes))
        if code != end:
            return float(code), float(end)
    return 0.0, 0.0
