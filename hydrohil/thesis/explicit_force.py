"""The filter that makes a position controller the equivalent explicit force controller (thesis 6.2.1, Figure 6-4).

C_FC = C_PC J^T (H + M_F), H = 1 / k_eff where the environment's own dynamics are fast (6.3), M_F = 1 / (m s^2 + c s + k);
J^T at a lever of 1 m, so that the filter is in m/N.
"""

import math
from collections.abc import Sequence

import control
import numpy as np

from hydrohil.claims.study import Curve, Panel, Studied
from hydrohil.claims.trace import Reals, Trace
from hydrohil.experiment.sections import UNIMATE_PARAMS
from hydrohil.thesis.readings import TENTH, about, below, printed

MASS_KG, NET_DAMPING = 500.0, 3.0  # Figure 6-4
EFFECTIVE_N_PER_M = 6200.0  # 6.3: environment plus sensor
STIFFNESSES_N_PER_M = (50.0, 500.0, 5000.0, 50e3)  # 6.3, and 7.2's fourth
TRIAL_S = 20.0  # shown; the text's trials of 6.3 end before a filter of 50 N/m has
EXACT = 1e-3  # of a computed steady state

_INVERSE = (
    'thesis 6.2.1: "In the limiting case of a stiff environment and sensor"; "the effective ultimate force control gain is '
    'inversely proportional to the target stiffness, as demonstrated in Figure 6-4"'
)
_STEADY = (
    'thesis 6.2.1: "The steady-state output of the equivalent controller under these conditions is a function of the target '
    'stiffness K."'
)
_ORDER = (
    'thesis 6.2.1: "the basic force control action is that of the underlying position controller modified by a second-order '
    'filter."'
)
_SLOW = (
    'thesis 6.3: "Inspection of Figure 6-4 shows that the trial durations were insufficient for the controller signal to reach '
    'full strength when a low target stiffness is specified."'
)


def filter_of(stiffness_n_per_m: float, effective_n_per_m: float = EFFECTIVE_N_PER_M) -> control.TransferFunction:
    """H + M_F in m/N;  c = 2 xi_net sqrt(m (k + k_eff))."""
    k, k_eff = stiffness_n_per_m, effective_n_per_m
    damping = 2.0 * NET_DAMPING * math.sqrt(MASS_KG * (k + k_eff))
    return control.tf([1.0], [k_eff]) + control.tf([1.0], [MASS_KG, damping, k])


def step_m_per_n(stiffness_n_per_m: float, times_s: Reals) -> Reals:
    """(n,) answer of the filter to a unit step of the position controller's output."""
    return np.asarray(control.step_response(filter_of(stiffness_n_per_m), times_s).outputs)


def ultimate_m_per_n(stiffness_n_per_m: float, effective_n_per_m: float = EFFECTIVE_N_PER_M) -> float:
    """Where the answer ends:  1 / k_eff + 1 / k."""
    return 1.0 / effective_n_per_m + 1.0 / stiffness_n_per_m


def settled_m_per_n(stiffness_n_per_m: float) -> float:
    """Where the computed answer is after twenty of its slowest time constants."""
    slowest_s = 1.0 / float(np.min(np.abs(control.poles(filter_of(stiffness_n_per_m)).real)))
    return float(step_m_per_n(stiffness_n_per_m, np.linspace(0.0, 20.0 * slowest_s, 2001))[-1])


def force_filter(_: Sequence[Trace]) -> Studied:
    """Figure 6-4: answers of the filter to a unit step for several target stiffnesses."""
    times = np.linspace(0.0, TRIAL_S, 801)
    answers = [step_m_per_n(k, times) for k in STIFFNESSES_N_PER_M]
    named = [f"k = {k:g} N/m" for k in STIFFNESSES_N_PER_M]
    stiffnesses = np.geomspace(10.0, 1e6, 101)
    gauge = UNIMATE_PARAMS.sensor_stiffness_n_per_m
    panels = (
        Panel("time, s", "output, mm/N", tuple(Curve(n, times, 1e3 * a) for n, a in zip(named, answers, strict=True))),
        Panel(
            "target stiffness, N/m",
            "ultimate output, mm/N",
            (
                Curve("soft plate", stiffnesses, 1e3 * (1.0 / EFFECTIVE_N_PER_M + 1.0 / stiffnesses)),
                Curve("rigid environment", stiffnesses, 1e3 * (1.0 / gauge + 1.0 / stiffnesses)),
                Curve("1 / k", stiffnesses, 1e3 / stiffnesses),
            ),
            log_x=True,
            log_y=True,
        ),
    )
    soft, stiff = STIFFNESSES_N_PER_M[0], STIFFNESSES_N_PER_M[2]
    ratio = ultimate_m_per_n(soft, gauge) / ultimate_m_per_n(stiff, gauge)
    reached = 100.0 * float(answers[0][-1]) / ultimate_m_per_n(soft)
    ends = ((k, settled_m_per_n(k) / ultimate_m_per_n(k)) for k in STIFFNESSES_N_PER_M)
    steady = tuple(about(f"k = {k:g}: ultimate output over 1/k_eff + 1/k", "1", 1.0, EXACT, end, _STEADY) for k, end in ends)
    verdicts = (
        about("Rigid environment: gain at 50 over gain at 5000 N/m", "1", stiff / soft, TENTH, ratio, _INVERSE),
        *steady,
        printed("Order of the filter", "counts", 2.0, 1.0, len(control.poles(filter_of(soft))), _ORDER),
        below("k = 50: share of full strength reached in 20 s", "%", 100.0 * (1.0 - TENTH), reached, _SLOW),
    )
    return Studied(panels, verdicts)
