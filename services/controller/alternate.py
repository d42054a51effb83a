"""The alternate formulation (b): damper and spring of the target feel where the tool is, not where it was sent (thesis 6.2.2).

    m x_s'' + c (x' - x_d') + k (x - x_d) = sign (f - f_d)

The set-point x_s is the acceleration integrated twice, free of any restoring force of its own. Inputs are held over each
interval, so the acceleration is constant and the solution exact; a step of x_d is a velocity step c/m dx_d.
"""

from hydrohil.services.controller.impedance import ImpedanceState
from hydrohil.services.controller.params import ImpedanceParams
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.machine.description import Triple


@kernel
def measured_axis(
    params: ImpedanceParams, set_m: float, set_m_per_s: float, step_m: float, error_m: float, v: float, push_n: float, dt_s: float
) -> tuple[float, float]:
    """(x_s, x_s') of one axis after `dt_s`: `error_m` is x - x_d, `step_m` the step of x_d, `v` the measured x'."""
    wn = params.natural_frequency_rad_per_s
    square, damping = wn * wn, 2.0 * params.damping_ratio * wn  # k/m, c/m
    set_m_per_s += damping * step_m
    acceleration = square * (push_n / params.stiffness_n_per_m - error_m) - damping * v
    return set_m + (set_m_per_s + 0.5 * acceleration * dt_s) * dt_s, set_m_per_s + acceleration * dt_s


@kernel
def measured_step(
    state: ImpedanceState, params: ImpedanceParams, nominal_m: Triple, x_m: Triple, v: Triple, force_error_n: float, dt_s: float
) -> tuple[ImpedanceState, Triple]:
    """The model after `dt_s` under x_d, the measured x and x' and f - gain f_d; and the set-point x_s."""
    position, velocity, last = state.position_m, state.velocity_m_per_s, state.nominal_m
    push_n = params.force_sign * force_error_n
    push_1 = push_n if params.force_axis == 0 else 0.0
    push_2 = push_n if params.force_axis == 1 else 0.0
    push_3 = push_n if params.force_axis == 2 else 0.0
    x1, v1 = measured_axis(
        params,
        position[0],
        set_m_per_s=velocity[0],
        step_m=nominal_m[0] - last[0],
        error_m=x_m[0] - nominal_m[0],
        v=v[0],
        push_n=push_1,
        dt_s=dt_s,
    )
    x2, v2 = measured_axis(
        params,
        position[1],
        set_m_per_s=velocity[1],
        step_m=nominal_m[1] - last[1],
        error_m=x_m[1] - nominal_m[1],
        v=v[1],
        push_n=push_2,
        dt_s=dt_s,
    )
    x3, v3 = measured_axis(
        params,
        position[2],
        set_m_per_s=velocity[2],
        step_m=nominal_m[2] - last[2],
        error_m=x_m[2] - nominal_m[2],
        v=v[2],
        push_n=push_3,
        dt_s=dt_s,
    )
    return ImpedanceState((x1, x2, x3), (v1, v2, v3), nominal_m, 0.0, 0.0, 0.0), (x1, x2, x3)
