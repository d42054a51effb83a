"""What the linearised model says of the thesis' statements on stability, and how far the rig agrees with the model."""

import math
from collections.abc import Sequence

import control
import numpy as np

from hydrohil.claims.signals import rms
from hydrohil.claims.study import Curve, Panel, Studied
from hydrohil.claims.trace import Reals, Trace
from hydrohil.experiment.sections import DOWN_UP_GAINS
from hydrohil.linear.closed_loop import closed_loop, loop_margins, poles
from hydrohil.linear.linear import LinearModel, OperatingPoint, Target, linear_model
from hydrohil.shared.units import A_PER_MA, A_PER_RAD_PER_MA_PER_DEG
from hydrohil.thesis.explicit_force import MASS_KG, NET_DAMPING
from hydrohil.thesis.library import find
from hydrohil.thesis.readings import TENTH, above, below

FREE, SOFT = "fig-5-2", "fig-5-5"
SATURATION_MA = 360.0  # 4.2: "The control signals saturated at 360mA."
CURRENTS_MA = np.linspace(45.0, SATURATION_MA, 22)
SHOWN_MA = (60.0, 120.0, 250.0)
STIFFNESSES_N_PER_M = np.geomspace(10.0, 1e6, 26)
FAST = OperatingPoint(250.0 * A_PER_MA)  # of the free space test, which asks for up to 15 deg/s
MODEL_STEP_S = 0.002

_LARGEST_GAIN = (
    'thesis Appendix C: "Establish maximum stable proportional gain using linear P-control."; Table 2, link 2: K_P is '
    '"215 mA/deg"'
)
_SMALL_K = 'thesis 6.2.1: "The equivalent controller will clearly be unstable for too small a value of K."'
_EXCEED = (
    'thesis 6.2.1: "the target stiffness must exceed the composite sensor-environment stiffness for stability"; 6.3: "a low '
    'composite stiffness results in greater steady-state controller gains"'
)
_REPLACED = (
    'thesis 5.2: "The impedance controller successfully replaces the existing manipulator dynamics with the specified target '
    'impedance."'
)
_SHARED = (
    'thesis 5.3: "This gain is the exact amount required to offset load-sharing and regain the correct steady-state force"; '
    '3.2.1: "These derivations and their results will be used subsequently for analysis."'
)


def proportional_alone(model: LinearModel) -> LinearModel:
    """The model under linear P-control."""
    return model._replace(position=model.position._replace(integral_a_per_m_s=0.0))


def ultimate_gain(spool_ma: float) -> float:
    """Largest stable K_P of link 2 in free space over that of Table 2, the orifice linearised at `spool_ma`."""
    model = proportional_alone(linear_model(find(FREE), OperatingPoint(spool_ma * A_PER_MA)))
    return loop_margins(model)[1].gain


def with_stiffness(model: LinearModel, stiffness_n_per_m: float) -> LinearModel:
    """The model with the target impedance of Figure 6-4 at another stiffness."""
    arm = model.arm
    k_s, k_e = arm.sensor_stiffness_n_per_m, arm.environment_stiffness_n_per_m
    k_eff = k_s * k_e / (k_s + k_e)
    damping = 2.0 * NET_DAMPING * math.sqrt(MASS_KG * (stiffness_n_per_m + k_eff))
    return model._replace(target=Target(MASS_KG, damping, stiffness_n_per_m, 1.0))


def slowest_decay_per_s(model: LinearModel) -> float:
    """Real part of the rightmost pole; positive is unstable."""
    return max(pole.real_per_s for pole in poles(model))


def answer(experiment: str, point: OperatingPoint, output: int, times_s: Reals) -> Reals:
    """(n,) X (output 0) or F (output 1) of the linear model for the experiment's force step."""
    step = find(experiment).reference[0]
    t_s = np.arange(0.0, float(times_s[-1]) + MODEL_STEP_S, MODEL_STEP_S)
    inputs = np.vstack((np.zeros_like(t_s), np.where(t_s >= step.start_s, step.amount, 0.0)))
    found = control.forced_response(closed_loop(linear_model(find(experiment), point)), t_s, inputs)
    return np.asarray(np.interp(times_s, t_s, np.asarray(found.outputs[output])))


def largest_gain_study(_: Sequence[Trace]) -> Studied:
    """The largest stable K_P over the spool current, against Table 2."""
    gains = np.array([ultimate_gain(spool_ma) for spool_ma in CURRENTS_MA.tolist()])
    kp = DOWN_UP_GAINS.kp_a_per_q / A_PER_RAD_PER_MA_PER_DEG
    curves = (
        Curve("largest stable K_P", CURRENTS_MA, kp * gains),
        Curve("Table 2", CURRENTS_MA, np.full_like(CURRENTS_MA, kp)),
    )
    verdicts = (
        above(
            "K_P of Table 2 is stable up to saturation: largest stable over K_P", "1", 1.0, float(np.min(gains)), _LARGEST_GAIN
        ),
        below("and hardly more is: the same within a tenth", "1", 1.0 + TENTH, float(np.min(gains)), _LARGEST_GAIN),
    )
    return Studied((Panel("spool, mA", "K_P, mA/deg", curves, log_y=True),), verdicts)


def stability_study(_: Sequence[Trace]) -> Studied:
    """Slowest pole and margin over the target stiffness, against 6.2.1."""
    decays, modulus = [], []
    for spool_ma in SHOWN_MA:
        models = [
            with_stiffness(linear_model(find(SOFT), OperatingPoint(spool_ma * A_PER_MA)), k) for k in STIFFNESSES_N_PER_M.tolist()
        ]
        decays.append(np.array([slowest_decay_per_s(model) for model in models]))
        modulus.append(np.array([loop_margins(model)[1].modulus for model in models]))
    named = [f"{spool_ma:g} mA" for spool_ma in SHOWN_MA]
    panels = (
        Panel(
            "target stiffness, N/m",
            "decay of the slowest mode, 1/s",
            tuple(Curve(n, STIFFNESSES_N_PER_M, -d) for n, d in zip(named, decays, strict=True)),
            log_x=True,
            log_y=True,
        ),
        Panel(
            "target stiffness, N/m",
            "smallest |1 + L| at the valve",
            tuple(Curve(n, STIFFNESSES_N_PER_M, m) for n, m in zip(named, modulus, strict=True)),
            log_x=True,
        ),
    )
    soft = linear_model(find(SOFT), OperatingPoint(SHOWN_MA[0] * A_PER_MA))
    growth = slowest_decay_per_s(with_stiffness(soft, 50.0))
    verdicts = (
        above("k = 50 N/m is unstable: real part of the rightmost pole", "1/s", 0.0, growth, _SMALL_K),
        above(
            "Stability grows with the target stiffness: |1 + L| at 50 kN/m over that at 50 N/m",
            "1",
            1.0,
            loop_margins(with_stiffness(soft, 50e3))[1].modulus / loop_margins(with_stiffness(soft, 50.0))[1].modulus,
            _EXCEED,
        ),
    )
    return Studied(panels, verdicts)


def response_study(traces: Sequence[Trace]) -> Studied:
    """Free space and soft plate: the rig beside the model."""
    free, soft = traces
    moved = free.x_m[0, 2] - free.x_m[:, 2]  # down is positive
    modelled = answer(FREE, FAST, 0, free.t_s)
    pressed = answer(SOFT, OperatingPoint(), 1, soft.t_s)
    panels = (
        Panel(
            "time, s", "down, m", (Curve("rig", free.t_s, moved), Curve("linear model", free.t_s, modelled)), title="free space"
        ),
        Panel("time, s", "force, N", (Curve("rig", soft.t_s, soft.force_n), Curve("linear model", soft.t_s, pressed))),
    )
    off_m = 100.0 * rms(moved - modelled) / abs(float(modelled[-1]))
    off_n = 100.0 * rms(soft.force_n - pressed) / abs(float(pressed[-1]))
    verdicts = (
        below("Free space: the rig off the linear model, rms over the step", "%", 100.0 * TENTH, off_m, _REPLACED),
        below("Soft plate: the rig off the linear model, rms over the step", "%", 100.0 * TENTH, off_n, _SHARED),
    )
    return Studied(panels, verdicts)
