"""The closed loop of thesis 3.2.1 in state space, its poles, margins and steady-state gains.

States are physical (set-point, integral, spool, load pressure, tip, environment): nothing cancels, and every pole is one.
"""

import cmath
import math
from typing import NamedTuple

import control
import numpy as np

from hydrohil.claims.trace import Reals
from hydrohil.linear.blocks import Complexes, arm_polynomials, blocks, gauge_block, responses, transport
from hydrohil.linear.linear import LinearModel, Target
from hydrohil.shared.units import RAD_PER_DEG

GRID = np.geomspace(1e-4, 1e4, 16001)  # rad/s: from a model of 50 N/m and 50 t to the Pade zeros


class Pole(NamedTuple):
    """A pole; a complex one stands for its pair."""

    real_per_s: float
    imag_rad_per_s: float
    frequency_rad_per_s: float
    damping_ratio: float


class Margins(NamedTuple):
    """Distance of a loop from instability; infinite where nothing crosses."""

    gain: float
    phase_deg: float
    modulus: float  # smallest |1 + L|
    gain_rad_per_s: float  # where L crosses -180 deg
    phase_rad_per_s: float  # where |L| is 1


class Steady(NamedTuple):
    """Gains at rest."""

    x_per_x_d: float
    x_per_f_d_m_per_n: float
    f_per_x_d_n_per_m: float
    f_per_f_d: float


def closed_loop(model: LinearModel) -> control.StateSpace:
    """(X_d, F_d) -> (X, F, U): the diagram of Figures 3-4 to 3-10."""
    a, p = model.actuator, model.position
    law = control.ss(
        [[0.0]],
        [[p.integral_a_per_m_s, -p.integral_a_per_m_s]],
        [[1.0]],
        [[p.proportional_a_per_m, -p.proportional_a_per_m]],
        inputs=["X_s", "X"],
        outputs=["U_law"],
        name="law",
    )
    path = control.ss(control.tf2ss(transport(p)), inputs=["U_law"], outputs=["U"], name="path")
    valve = control.ss(
        [[-a.leak_m3_per_s_pa / a.half_compressibility_m3_per_pa]],
        [[a.flow_m3_per_s_a / a.half_compressibility_m3_per_pa, -a.area_m2 / a.half_compressibility_m3_per_pa]],
        [[a.area_m2]],
        [[0.0, 0.0]],
        inputs=["U", "V"],
        outputs=["T"],
        name="valve",
    )
    subsystems = [target_states(model.target), gauge_states(model.target), law, path, valve, arm_states(model)]
    return control.interconnect(subsystems, inputs=["X_d", "F_d"], outputs=["X", "F", "U"])


def target_states(m: Target) -> control.StateSpace:
    """(X_d, F_d, F_seen, X) -> X_s, with states x_s and x_s' - c/m x_d (or x_d - x), so that no input is differentiated."""
    kick, stiff = m.damping_ns_per_m / m.mass_kg, m.stiffness_n_per_m / m.mass_kg
    push = [m.force_gain / m.mass_kg, -1.0 / m.mass_kg]
    states, drive = [[0.0, 1.0], [-stiff, -kick]], [[kick, 0.0, 0.0, 0.0], [stiff - kick * kick, *push, 0.0]]
    if m.feels_measured:
        states, drive = [[0.0, 1.0], [0.0, 0.0]], [[kick, 0.0, 0.0, -kick], [stiff, *push, -stiff]]
    names = ["X_d", "F_d", "F_seen", "X"]
    return control.ss(states, drive, [[1.0, 0.0]], np.zeros((1, 4)), inputs=names, outputs=["X_s"], name="impedance")


def gauge_states(m: Target) -> control.StateSpace:
    """F -> F_seen."""
    return control.ss(control.tf2ss(gauge_block(m)), inputs=["F"], outputs=["F_seen"], name="gauge")


def arm_states(model: LinearModel) -> control.StateSpace:
    """T -> (X, V, F), one realisation of R_X, s R_X and R_F in controllable form."""
    above_x, above_f, below = arm_polynomials(model.arm)
    order = len(below) - 1
    outputs = np.zeros((3, order))
    for row, polynomial in enumerate((above_x, np.append(above_x, 0.0), above_f)):
        outputs[row, order - len(polynomial) :] = polynomial / below[0]
    states = np.eye(order, k=-1)
    states[0] = -below[1:] / below[0]
    drive = np.eye(order, 1)
    return control.ss(states, drive, outputs, np.zeros((3, 1)), inputs=["T"], outputs=["X", "V", "F"], name="arm")


def poles(model: LinearModel) -> tuple[Pole, ...]:
    """Poles of the closed loop, slowest first."""
    found = [pole for pole in control.poles(closed_loop(model)) if pole.imag >= 0.0]
    return tuple(
        Pole(float(pole.real), float(pole.imag), abs(complex(pole)), -float(pole.real) / abs(complex(pole)) if pole else 1.0)
        for pole in sorted(found, key=abs)
    )


def is_stable(model: LinearModel) -> bool:
    """Whether every pole of the closed loop decays."""
    return all(pole.real_per_s < 0.0 for pole in poles(model))


def margins(loop: Complexes, angular_rad_per_s: Reals = GRID) -> Margins:
    """Margins of a loop's frequency response (n,): of several crossings the one nearest to instability."""
    turned = [point for point in crossings(loop, angular_rad_per_s, loop.imag) if point[0].real < 0.0]
    even = crossings(loop, angular_rad_per_s, np.abs(loop) - 1.0)
    gains = [(1.0 / abs(value), at) for value, at in turned]
    phases_deg = [(cmath.phase(-value) / RAD_PER_DEG, at) for value, at in even]
    gain, gain_at = min(gains, key=lambda pair: abs(math.log(pair[0])), default=(math.inf, math.nan))
    phase_deg, phase_at = min(phases_deg, key=lambda pair: abs(pair[0]), default=(math.inf, math.nan))
    return Margins(
        gain=gain,
        phase_deg=phase_deg,
        modulus=float(np.min(np.abs(1.0 + loop))),
        gain_rad_per_s=gain_at,
        phase_rad_per_s=phase_at,
    )


def crossings(loop: Complexes, angular_rad_per_s: Reals, signed: Reals) -> list[tuple[complex, float]]:
    """(L, frequency) where `signed` (n,) changes sign, between the points of the grid."""
    found = []
    for row in np.flatnonzero(signed[:-1] * signed[1:] < 0.0).tolist():
        share = signed[row] / (signed[row] - signed[row + 1])
        between = [values[row] + share * (values[row + 1] - values[row]) for values in (loop, angular_rad_per_s)]
        found.append((complex(between[0]), float(between[1])))
    return found


def loop_margins(model: LinearModel) -> tuple[Margins, Margins]:
    """Margins of the thesis' loop  R_F A C M_F + R_X A (C + Q_v),  and of the loop broken at the valve's current."""
    response = responses(blocks(model), GRID)
    return margins(response.loop), margins(response.valve_loop)


def steady(model: LinearModel) -> Steady:
    """Gains at rest; with an integral in C they are those of the springs alone."""
    gains = control.dcgain(closed_loop(model))
    return Steady(float(gains[0, 0]), float(gains[0, 1]), float(gains[1, 0]), float(gains[1, 1]))
