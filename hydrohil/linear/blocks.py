"""The blocks of thesis 3.2.1 as transfer functions, and their loop and closed loop at a frequency.

Products of blocks are taken frequency by frequency: as polynomials of order ten they would lose their digits.
"""

import math
from typing import Any, NamedTuple

import control
import numpy as np
import numpy.typing as npt

from hydrohil.claims.trace import Reals
from hydrohil.linear.linear import Actuator, Arm, LinearModel, Position, Target

Complexes = npt.NDArray[np.complex128]
PADE_ORDER = 3  # exact to 1 deg up to 60 Hz at a delay of 6 ms


class Blocks(NamedTuple):
    """Transfer functions of Figures 3-5 to 3-9; Q_v is improper, as printed."""

    actuator: control.TransferFunction  # A, N/A
    velocity: control.TransferFunction  # Q_v, A/m
    controller: control.TransferFunction  # C, A/m, with delay and spool where the model has them
    model_x: control.TransferFunction  # M_X
    model_f: control.TransferFunction  # M_F, m/N
    robot_x: control.TransferFunction  # R_X, m/N
    robot_f: control.TransferFunction  # R_F
    gauge: control.TransferFunction  # filter of the gauge's reading, 1 without one
    felt_x: control.TransferFunction  # what returns of X: 1, or 1 + M_X where the target feels X (6.2.2)
    force_gain: float


def actuator_blocks(a: Actuator) -> tuple[control.TransferFunction, control.TransferFunction]:
    """A = K_x A_p / (C s / 2 + G),  Q_v = A_p s / K_x."""
    forward = control.tf([a.flow_m3_per_s_a * a.area_m2], [a.half_compressibility_m3_per_pa, a.leak_m3_per_s_pa])
    return forward, control.tf([a.area_m2 / a.flow_m3_per_s_a, 0.0], [1.0])


def controller_block(c: Position) -> control.TransferFunction:
    """C = (K_P + K_I / s) e^(-s delay) / (tau s + 1)."""
    law = control.tf([c.proportional_a_per_m, c.integral_a_per_m_s], [1.0, 0.0])
    return law * transport(c)


def transport(c: Position) -> control.TransferFunction:
    """Delay (Pade) and spool between the control law and the port; 1 where the model has neither."""
    spool = control.tf([1.0], [c.spool_lag_s, 1.0]) if c.spool_lag_s > 0.0 else control.tf([1.0], [1.0])
    return spool * control.tf(*control.pade(c.delay_s, PADE_ORDER)) if c.delay_s > 0.0 else spool


def target_blocks(m: Target) -> tuple[control.TransferFunction, control.TransferFunction]:
    """M_X = (c s + k) / (m s^2 + c s + k),  M_F = 1 / (m s^2 + c s + k);  over m s^2 where the target feels X (6.2.2 b)."""
    below = [m.mass_kg, 0.0, 0.0] if m.feels_measured else [m.mass_kg, m.damping_ns_per_m, m.stiffness_n_per_m]
    return control.tf([m.damping_ns_per_m, m.stiffness_n_per_m], below), control.tf([1.0], below)


def gauge_block(m: Target) -> control.TransferFunction:
    """w^2 / (s^2 + sqrt(2) w s + w^2), or 1."""
    w = m.filter_rad_per_s
    return control.tf([w * w], [1.0, math.sqrt(2.0) * w, w * w]) if w > 0.0 else control.tf([1.0], [1.0])


def arm_polynomials(a: Arm) -> tuple[Reals, Reals, Reals]:
    """(numerator of R_X, of R_F, common denominator), highest power first.

    Contact: the fourth order of Figure 3-10a, with the gauge reading k_s s + c_s s', which is what presses on the tool
    (printed: its spring alone). Free motion: 1 / (m_A s^2 + c_r s + k_r) and 0.
    """
    free = np.array([a.mass_kg, a.damping_ns_per_m, a.stiffness_n_per_m])
    around = np.array([a.environment_mass_kg, a.environment_damping_ns_per_m, a.environment_stiffness_n_per_m])
    if not np.any(around):
        return np.array([1.0]), np.array([0.0]), free
    sensor = np.array([a.sensor_damping_ns_per_m, a.sensor_stiffness_n_per_m])
    inner = np.polyadd(around, sensor)
    pressed = np.polymul(around, sensor)
    return trimmed(inner), trimmed(pressed), trimmed(np.polyadd(np.polymul(inner, free), pressed))


def trimmed(polynomial: Any) -> Reals:
    """The polynomial without leading zeros: a massless plate lowers the order."""
    return np.asarray(np.trim_zeros(np.atleast_1d(polynomial), "f"), dtype=np.float64)


def blocks(model: LinearModel) -> Blocks:
    """Every block of the model."""
    forward, velocity = actuator_blocks(model.actuator)
    model_x, model_f = target_blocks(model.target)
    above_x, above_f, below = arm_polynomials(model.arm)
    return Blocks(
        actuator=forward,
        velocity=velocity,
        controller=controller_block(model.position),
        model_x=model_x,
        model_f=model_f,
        robot_x=control.tf(above_x, below),
        robot_f=control.tf(above_f, below),
        gauge=gauge_block(model.target),
        felt_x=1.0 + model_x if model.target.feels_measured else control.tf([1.0], [1.0]),
        force_gain=model.target.force_gain,
    )


class Responses(NamedTuple):
    """Frequency responses (n,): the loops, and X and F over their set-points."""

    loop: Complexes  # L of 1 + L,  L = R_F A C M_F + R_X A (C + Q_v)  (3.2.1)
    valve_loop: Complexes  # broken at the valve's current:  C A (R_X + M_F R_F) / (1 + R_X A Q_v)
    x_per_x_d: Complexes
    x_per_f_d: Complexes  # m/N
    f_per_x_d: Complexes  # N/m
    f_per_f_d: Complexes


def responses(b: Blocks, angular_rad_per_s: Reals) -> Responses:
    """The closed loop of 3.2.1,  X = R_X A C (M_X X_d + M_F F_d) / (1 + L)  and  F = R_F A C (...) / (1 + L).

    A filter of the gauge stands with M_F in the loop, and 1 + M_X with C where the target feels X.
    """
    s = 1j * angular_rad_per_s
    a, q, c, m_x, m_f, r_x, r_f, h, felt = (np.asarray(block(s)) for block in b[:9])
    loop = r_f * a * c * m_f * h + r_x * a * (c * felt + q)
    x, f = r_x * a * c / (1.0 + loop), r_f * a * c / (1.0 + loop)
    valve_loop = c * a * (r_x * felt + m_f * r_f * h) / (1.0 + r_x * a * q)
    gain = b.force_gain
    return Responses(
        loop=loop, valve_loop=valve_loop, x_per_x_d=x * m_x, x_per_f_d=x * m_f * gain, f_per_x_d=f * m_x, f_per_f_d=f * m_f * gain
    )
