"""A soft apparent stiffness by way of a stiff target: set-point compensation for position (thesis 9.3.2).

A target of k in contact with k_eff presses with  f = k k_eff / (k + k_eff) x  where its nominal position lies x below the
surface. A stable k_+ presses like the k_- that is asked for if the nominal position goes on by

    dx_d* = k_- (k_+ + k_eff) / (k_+ (k_- + k_eff)) dx_d

while there is contact (the thesis lost its parentheses). The offset that grows on the way in is given back on the way out.
"""

from typing import NamedTuple

from hydrohil.services.controller.params import SetpointScalingParams
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.machine.description import Triple


class Offset(NamedTuple):
    """How far the compensated nominal position has stayed behind the reference along the gauge's axis."""

    offset_m: float
    reference_m: Triple  # x_d of the last sample


@kernel
def offset_step(state: Offset, params: SetpointScalingParams, axis: int, reference_m: Triple, force_n: float) -> Offset:
    """State after the reference has gone to `reference_m` while the gauge reads `force_n`, compression positive."""
    offset_m = state.offset_m
    if force_n > params.contact_n:
        offset_m += (1.0 - params.share) * (reference_m[axis] - state.reference_m[axis])
    return Offset(offset_m, reference_m)
