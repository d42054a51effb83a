"""Three ways to keep the contact force below a ceiling by changing the target impedance on-line (thesis 9.3.4).

All see the same excess: 0 below an onset, 1 where the force reaches the ceiling, linear between and beyond.

* stiffness: the excess softens the spring, k' = -rate excess k; below the onset it hardens again, k' = (k_0 - k) / release.
* offset: the excess draws the position set-point away from the surface, o' = speed excess; below the onset o' = -o / release.
* limit switch: a stop behind the gauge, a spring with a damper, engages at the onset; it pushes the model away from the
  surface with stop excess and brakes its motion with d x', without memory.

The mass stays, and so does the damping ratio: c = 2 xi sqrt(m k) falls with the square root of k, since the damper too
presses on the surface, with c xd'. The axes across the gauge's stay as they are.
"""

import math

from hydrohil.services.controller.impedance import ImpedanceState, impedance_step
from hydrohil.services.controller.kinematics import along_axis
from hydrohil.services.controller.params import ADAPT_LIMIT_SWITCH, ADAPT_NONE, ADAPT_OFFSET, AdaptationParams, ImpedanceParams
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.machine.description import Triple

LEAST_SHARE = 0.1  # of the target stiffness: it leaves a third of the damping, and a spring that brings the model back


@kernel
def force_excess(adaptation: AdaptationParams, force_n: float) -> float:
    """0 up to the onset, 1 at the ceiling; NaN stays NaN."""
    if force_n <= adaptation.onset_n:
        return 0.0
    return (force_n - adaptation.onset_n) / (adaptation.ceiling_n - adaptation.onset_n)


@kernel
def stiffness_loss_step(stiffness_loss: float, adaptation: AdaptationParams, excess: float, dt_s: float) -> float:
    """What the target has given way after `dt_s` of `excess`: the share of its stiffness that is lost, or its offset in m.

    Exact for an excess held over the interval.
    """
    if excess == 0.0:
        return stiffness_loss * math.exp(-dt_s / adaptation.release_s) if dt_s >= 0.0 else math.nan
    if adaptation.kind == ADAPT_OFFSET:
        return stiffness_loss + adaptation.retreat_m_per_s * excess * dt_s
    softening = adaptation.softening_per_s * excess * dt_s
    share = (1.0 - stiffness_loss) * math.exp(-softening) if softening >= 0.0 else math.nan
    return 1.0 - share if not share < LEAST_SHARE else 1.0 - LEAST_SHARE


@kernel
def retuned(params: ImpedanceParams, stiffness_n_per_m: float, wn_rad_per_s: float, xi: float) -> ImpedanceParams:
    """`params` with another spring, natural frequency and damping ratio."""
    return ImpedanceParams(
        stiffness_n_per_m=stiffness_n_per_m,
        natural_frequency_rad_per_s=wn_rad_per_s,
        damping_ratio=xi,
        force_gain=params.force_gain,
        force_axis=params.force_axis,
        force_sign=params.force_sign,
        environment_n_per_m=params.environment_n_per_m,
        formulation=params.formulation,
    )


@kernel
def softened(params: ImpedanceParams, stiffness_loss: float) -> ImpedanceParams:
    """The target with the share `stiffness_loss` of its stiffness gone; m and xi are kept."""
    share = 1.0 - stiffness_loss
    root = math.sqrt(share) if share > 0.0 else math.nan
    wn = params.natural_frequency_rad_per_s * root
    return retuned(params, params.stiffness_n_per_m * share, wn, params.damping_ratio)


@kernel
def braked(params: ImpedanceParams, damping_ns_per_m: float) -> ImpedanceParams:
    """The target with `damping_ns_per_m` beside its c; m and k are kept:  xi + d wn / (2 k)."""
    k, wn = params.stiffness_n_per_m, params.natural_frequency_rad_per_s
    return retuned(params, k, wn, params.damping_ratio + damping_ns_per_m * wn / (2.0 * k))


@kernel
def spliced(across: Triple, along: Triple, axis: int) -> Triple:
    """`along` on one axis, `across` on the other two."""
    return (
        along[0] if axis == 0 else across[0],
        along[1] if axis == 1 else across[1],
        along[2] if axis == 2 else across[2],
    )


@kernel
def with_stiffness_loss(state: ImpedanceState, stiffness_loss: float) -> ImpedanceState:
    """`state` with another loss of stiffness."""
    return ImpedanceState(
        state.position_m,
        state.velocity_m_per_s,
        state.nominal_m,
        state.force_offset_m,
        state.force_velocity_m_per_s,
        stiffness_loss,
    )


@kernel
def split_step(
    state: ImpedanceState,
    params: ImpedanceParams,
    adapted: ImpedanceParams,
    nominal_m: Triple,
    force_error_n: float,
    dt_s: float,
) -> tuple[ImpedanceState, Triple]:
    """`impedance_step` with the `adapted` target along the gauge's axis, and with `params` across.

    The target of a sample holds for the whole interval; position and velocity of the model go on from there.
    """
    axis = params.force_axis
    across, x_across = impedance_step(state, params, nominal_m, force_error_n, dt_s)
    along, x_along = impedance_step(state, adapted, nominal_m, force_error_n, dt_s)
    position_m = spliced(across.position_m, along.position_m, axis)
    velocity_m_per_s = spliced(across.velocity_m_per_s, along.velocity_m_per_s, axis)
    new = ImpedanceState(
        position_m, velocity_m_per_s, nominal_m, along.force_offset_m, along.force_velocity_m_per_s, state.stiffness_loss
    )
    return new, spliced(x_across, x_along, axis)


@kernel
def stopped_step(
    state: ImpedanceState,
    params: ImpedanceParams,
    adaptation: AdaptationParams,
    excess: float,
    nominal_m: Triple,
    force_error_n: float,
    dt_s: float,
) -> tuple[ImpedanceState, Triple]:
    """`impedance_step` against the engaged stop:  m x'' + c (x' - xd') + d x' + k (x - xd) = f + stop excess.

    `impedance_step` would let a step of xd kick through d as through c; the stop's other end stands, so that is taken back.
    """
    axis, d, wn = params.force_axis, adaptation.stop_ns_per_m, params.natural_frequency_rad_per_s
    kick = d * wn * wn / params.stiffness_n_per_m * (nominal_m[axis] - state.nominal_m[axis])  # d/m dx_d
    standing = ImpedanceState(
        state.position_m,
        along_axis(state.velocity_m_per_s, axis, -kick),
        state.nominal_m,
        state.force_offset_m,
        state.force_velocity_m_per_s,
        state.stiffness_loss,
    )
    return split_step(standing, params, braked(params, d), nominal_m, force_error_n + adaptation.stop_n * excess, dt_s)


@kernel
def adapted_step(
    state: ImpedanceState,
    params: ImpedanceParams,
    adaptation: AdaptationParams,
    nominal_m: Triple,
    force_n: float,
    force_error_n: float,
    dt_s: float,
) -> tuple[ImpedanceState, Triple]:
    """`impedance_step` of a target that gives way where `force_n`, the gauge's force, comes near the ceiling."""
    if adaptation.kind == ADAPT_NONE:
        return impedance_step(state, params, nominal_m, force_error_n, dt_s)
    excess = force_excess(adaptation, force_n)
    if adaptation.kind == ADAPT_LIMIT_SWITCH:
        if excess == 0.0:
            return impedance_step(state, params, nominal_m, force_error_n, dt_s)
        return stopped_step(
            state, params, adaptation=adaptation, excess=excess, nominal_m=nominal_m, force_error_n=force_error_n, dt_s=dt_s
        )
    relieved = with_stiffness_loss(state, stiffness_loss_step(state.stiffness_loss, adaptation, excess, dt_s))
    if adaptation.kind == ADAPT_OFFSET:
        away_m = along_axis(nominal_m, params.force_axis, params.force_sign * relieved.stiffness_loss)
        return impedance_step(relieved, params, away_m, force_error_n, dt_s)
    return split_step(relieved, params, softened(params, relieved.stiffness_loss), nominal_m, force_error_n, dt_s)
