"""A soft apparent stiffness by way of a stiff target: set-point compensation for position (thesis 9.3.2).

A target of k in contact with k_eff presses with  f = k k_eff / (k + k_eff) x  where its nominal position lies x below the
surface. A stable k_+ presses like the wanted k_- if the nominal position goes on by

    dx_d* = k_- (k_+ + k_eff) / (k_+ (k_- + k_eff)) dx_d

while there is contact (the thesis lost its parentheses). What is withheld on the way in is given back on the way out.
"""

from typing import NamedTuple

from hydrohil.services.controller.params import ApparentParams
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.pose import Triple


class Withheld(NamedTuple):
    """How far the compensated nominal position has stayed behind the reference along the gauge's axis."""

    withheld_m: float
    reference_m: Triple  # x_d of the last sample


@kernel
def withhold(state: Withheld, params: ApparentParams, axis: int, reference_m: Triple, force_n: float) -> Withheld:
    """State after the reference has gone to `reference_m` while the gauge reads `force_n`, compression positive."""
    withheld_m = state.withheld_m
    if force_n > params.contact_n:
        withheld_m += (1.0 - params.share) * (reference_m[axis] - state.reference_m[axis])
    return Withheld(withheld_m, reference_m)
