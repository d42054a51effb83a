"""The signals by which a controller recognises a stuck link: Figures 4-14 and 4-15 of the thesis, section 4.5.3."""

from collections.abc import Sequence

import numpy as np

from hydrohil.claims.motion import first_motion_s
from hydrohil.claims.study import Curve, Panel, Studied
from hydrohil.claims.trace import Reals, Trace, window
from hydrohil.experiment.sections import DOWN_UP_GAINS
from hydrohil.services.controller.laws.parts import stiction_rate
from hydrohil.shared.units import RAD_PER_DEG
from hydrohil.thesis.readings import HALF, TENTH, above, below

DOWN_UP = 1
SHOWN_S = 1.0  # "the first second"
RATES_DEG_PER_S = 2.0  # the shown part of the velocity plane
LINES_DEG_PER_S = (-1.0, -0.5, -0.25, 0.25, 0.5, 1.0)  # set-point velocities

_LARGEST = (
    'thesis 4.5.3: "the largest error signal during an occurrence of stiction is the velocity error."; "integral based methods '
    'of stiction compensation rely on the smallest signal. The velocity error provides a much stronger signal."'
)
_LINE = (
    'thesis 4.5.3: "The estimate is appreciable only in the portion of the velocity plane where stiction occurs: along the '
    "line q' = 0.\""
)
_FACTOR = 'thesis 4.5.3: "The nonlinear factor is greatest when q\' is zero, which is when stiction occurs."'
_UNCHANGING = 'thesis 4.5.3: "so that the estimate would be zero when the set-point was unchanging."'
_MOTION = 'thesis 4.5.3: "the estimate, and therefore the control signal, will drop to near zero with any motion."'


def signals(trace: Trace) -> tuple[Reals, Reals, Reals, Reals]:
    """Times in s; position error in deg, velocity error in deg/s, error integral in deg s of link 2, (n,) each."""
    error = (trace.q_set[:, DOWN_UP] - trace.q[:, DOWN_UP]) / RAD_PER_DEG
    rate = (trace.qd_set[:, DOWN_UP] - trace.qd[:, DOWN_UP]) / RAD_PER_DEG
    steps = (error[1:] + error[:-1]) / 2.0 * np.diff(trace.t_s)
    return trace.t_s, error, rate, np.concatenate(([0.0], np.cumsum(steps)))


def signals_study(traces: Sequence[Trace]) -> Studied:
    """Figure 4-14: velocity error, error and its integral in the first second of Figure 4-9."""
    shown = window(traces[0], 0.0, SHOWN_S)
    times, error, rate, integral = signals(shown)
    free_s = first_motion_s(shown, "q2")
    stuck = times <= free_s if free_s == free_s else times <= SHOWN_S
    means = [float(np.mean(np.abs(values[stuck]))) for values in (rate, error, integral)]
    curves = (
        Curve("velocity error, deg/s", times, rate),
        Curve("position error, deg", times, error),
        Curve("error integral, deg s", times, integral),
    )
    verdicts = (
        above("The velocity error is much stronger than the position error", "1", 1.0 + HALF, means[0] / means[1], _LARGEST),
        above("The error's integral is smaller still", "1", 1.0, means[1] / means[2], _LARGEST),
    )
    return Studied((Panel("time, s", "deg, deg/s, deg s", curves),), verdicts)


def estimate_deg_per_s(rates: Reals, set_rates: Reals) -> Reals:
    """(n,) the controller's velocity error caused by stiction, for velocities and set-point velocities in deg/s."""
    pairs = zip((rates * RAD_PER_DEG).tolist(), (set_rates * RAD_PER_DEG).tolist(), strict=True)
    return np.array([stiction_rate(DOWN_UP_GAINS, rate, set_rate) for rate, set_rate in pairs]) / RAD_PER_DEG


def half_factor_rate(set_rates: Reals) -> Reals:
    """Velocity at which the nonlinear factor is a half:  |q'| = |q_s'| / sqrt(beta)."""
    return np.asarray(np.abs(set_rates) / np.sqrt(DOWN_UP_GAINS.stiction_selectivity))


def plane_study(_: Sequence[Trace]) -> Studied:
    """Figure 4-15: the stiction error over measured and set velocity."""
    axis = np.linspace(-RATES_DEG_PER_S, RATES_DEG_PER_S, 161)
    rates, set_rates = (grid.ravel() for grid in np.meshgrid(axis, axis))
    surface = estimate_deg_per_s(rates, set_rates)
    along = estimate_deg_per_s(axis, np.full_like(axis, 1.0))
    factor = along[axis != 1.0] / (1.0 - axis[axis != 1.0])
    lines = tuple(Curve(f"{v:g} deg/s set", axis, estimate_deg_per_s(axis, np.full_like(axis, v))) for v in LINES_DEG_PER_S)
    edge = half_factor_rate(axis)
    region = (Curve("factor 1/2", edge, axis), Curve("", -edge, axis), Curve("q' = q_s'", axis, axis))
    panels = (
        Panel("q', deg/s", "stiction error, deg/s", lines),
        Panel("q', deg/s", "q_s', deg/s", region, title="the estimate acts between the two lines"),
    )
    share = 100.0 * float(np.mean(np.abs(surface) > HALF * np.max(np.abs(surface))))
    unchanging = float(np.max(np.abs(estimate_deg_per_s(axis, np.zeros_like(axis)))))
    moving = estimate_deg_per_s(np.array([0.5]), np.array([1.0]))[0]
    greatest = abs(float(axis[axis != 1.0][np.argmax(factor)]))
    verdicts = (
        below("Share of the velocity plane with half of the largest estimate", "%", 100.0 * TENTH, share, _LINE),
        below("Velocity at which the nonlinear factor is greatest", "deg/s", 0.0, greatest, _FACTOR),
        below("Estimate while the set-point stands", "deg/s", 0.0, unchanging, _UNCHANGING),
        below("Estimate at half of the set velocity, over that when stuck", "1", TENTH, moving, _MOTION),
    )
    return Studied(panels, verdicts)
