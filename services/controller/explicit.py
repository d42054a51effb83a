"""Explicit force control that is equivalent to position based impedance control (thesis 6.2.1; `equiv_f_cont` of Appendix F).

On a spring k_eff the impedance controller behaves as  u = C J^-1 (H + M_F) (f_d' - f)  with the position law C and

    f_d' = k_eff / (m s^2 + c s + k + k_eff)  f_d      what model and environment share (`mod_f`)
    H + M_F = 1 / k_eff + 1 / (m s^2 + c s + k)        the position that a force error stands for (`mod_c`)

The program takes law and filter in the other order, which is the same for a linear law, and forms the filter's feed-through by
differentiating its own output numerically; as a sum it needs no derivative. The thesis prints J^T, which is J^-1 at a lever of
1 m only; here the inverse kinematics of the way are J^-1. Both forces come as means of three samples, as the target impedance
takes them; the program averages the measured one alone.
"""

import math
from typing import NamedTuple

from hydrohil.services.controller.impedance import decay, respond
from hydrohil.services.controller.params import ImpedanceParams
from hydrohil.shared.compiled.kernel import kernel


class ExplicitState(NamedTuple):
    """Responses of the two filters, in m."""

    shared_m: float = 0.0  # of model and environment to the force set-point
    shared_m_per_s: float = 0.0
    yielded_m: float = 0.0  # of the model alone to the force error
    yielded_m_per_s: float = 0.0


FILTERS_AT_REST = ExplicitState()


@kernel
def explicit_step(
    state: ExplicitState, params: ImpedanceParams, force_n: float, force_set_n: float, dt_s: float
) -> tuple[ExplicitState, float]:
    """Filters after `dt_s`; and the way along the gauge's axis, in m, that the force error asks the tool to go.

    Inputs are held over the interval. NaN where k and k_eff are not positive.
    """
    wn, xi, k, k_eff = (
        params.natural_frequency_rad_per_s,
        params.damping_ratio,
        params.stiffness_n_per_m,
        params.environment_n_per_m,
    )
    if not (k > 0.0 and 0.0 < k_eff < math.inf):
        return state, math.nan
    stiffening = math.sqrt(1.0 + k_eff / k)  # of wn by the environment, which takes as much from xi
    both = decay(wn * stiffening, xi / stiffening, dt_s)
    shared, shared_rate = respond(both, state.shared_m, state.shared_m_per_s, force_set_n / (k + k_eff))
    error_n = force_n - k_eff * shared
    yielded, rate = respond(decay(wn, xi, dt_s), state.yielded_m, state.yielded_m_per_s, error_n / k)
    return ExplicitState(shared, shared_rate, yielded, rate), params.force_sign * (error_n / k_eff + yielded)
