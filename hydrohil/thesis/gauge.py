"""Stiffness of the force gauge by regression, as by hand: force against the gripper's distance (thesis Appendix E)."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.stats import linregress, t

from hydrohil.claims.study import Curve, Panel, Studied
from hydrohil.claims.trace import Reals, Trace
from hydrohil.thesis.appendix import CHAIR_N_PER_M, LEVEL_S, LEVELS_N
from hydrohil.thesis.plate import KILO, M_PER_IN
from hydrohil.thesis.readings import TENTH, about, below

HAND_RANGE_M = 0.5 * M_PER_IN  # Appendix E: measurements at one force vary by up to that
TRIALS = 20  # at each force level; the text does not say
SETTLED = 0.5  # a level is measured in its second half
CONFIDENCE = 0.95
STATED_N_PER_M = 46e3

_STIFFNESS = (
    'thesis 5.1.2: "This latitude accounts for some of the scatter in measurement of the sensor stiffness, which was '
    'determined to be 46kN/m (see Appendix E)."'
)
_SCATTER = (
    'thesis Appendix E: "The measurements varied by up to 0.5 inches between trials at a given force level"; "This variation was '
    'not compensated for (except through statistical methods)"'
)


class Fit(NamedTuple):
    """Compliance of the gauge by regression of distance on force, with the half width of its 95 % interval, in m/N."""

    compliance_m_per_n: float
    half_width_m_per_n: float
    offset_m: float


def readings(trace: Trace) -> tuple[Reals, Reals]:
    """(levels * trials,) force in N and how far the gripper has come to the object's surface in m, read without scatter.

    The object gives way by f / k itself, which a tape between surface and gripper does not see.
    """
    forces, nearer = [], []
    for level in range(len(LEVELS_N)):
        start_s = (level + 1.0 - SETTLED) * LEVEL_S
        edges = np.linspace(start_s, start_s + SETTLED * LEVEL_S, TRIALS + 1)
        for low_s, high_s in pairwise(edges):
            held = (trace.t_s >= low_s) & (trace.t_s < high_s)
            forces.append(float(np.mean(trace.force_n[held])))
            nearer.append(-float(np.mean(trace.x_m[held, 2])) - forces[-1] / CHAIR_N_PER_M)
    return np.array(forces), np.array(nearer) - nearer[0]


def scattered(trace: Trace, distances_m: Reals) -> Reals:
    """(n,) the distances as measured by hand: off by up to a quarter of an inch, other from trial to trial."""
    hand = np.random.default_rng(int(np.sum(trace.force_counts)))
    return distances_m + hand.uniform(-HAND_RANGE_M / 2.0, HAND_RANGE_M / 2.0, len(distances_m))


def fit(forces_n: Reals, distances_m: Reals) -> Fit:
    """Least squares of distance on force: the hand's error is in the distance."""
    line = linregress(forces_n, distances_m)
    reach = float(t.ppf((1.0 + CONFIDENCE) / 2.0, len(forces_n) - 2))
    return Fit(float(line.slope), reach * float(line.stderr), float(line.intercept))


def gauge_study(traces: Sequence[Trace]) -> Studied:
    """Figure 9-2: force over deflection, measured by hand, and the line through it."""
    forces, exact = readings(traces[0])
    measured = scattered(traces[0], exact)
    bare, found = fit(forces, exact), fit(forces, measured)
    low, high = found.compliance_m_per_n - found.half_width_m_per_n, found.compliance_m_per_n + found.half_width_m_per_n
    ends = np.array([0.0, float(np.max(forces))])
    words = f"{1.0 / found.compliance_m_per_n / KILO:.3g} kN/m, 95 % interval {1.0 / high / KILO:.3g}.." + (
        f"{1.0 / low / KILO:.3g}" if low > 0.0 else "unbounded"
    )
    curves = (
        Curve("by hand", 1e3 * measured, forces, points=True),
        Curve("by the encoders", 1e3 * exact, forces, points=True),
        Curve("regression", 1e3 * (found.offset_m + found.compliance_m_per_n * ends), ends),
    )
    off = abs(found.compliance_m_per_n - 1.0 / STATED_N_PER_M) / found.half_width_m_per_n
    verdicts = (
        about(
            "Stiffness read by the encoders, without a hand",
            "kN/m",
            STATED_N_PER_M / KILO,
            TENTH,
            1.0 / bare.compliance_m_per_n / KILO,
            _STIFFNESS,
        ),
        below("46 kN/m from the regression, in half widths of its 95 % interval", "1", 1.0, off, _SCATTER),
    )
    return Studied((Panel("deflection, mm", "force, N", curves, title=words),), verdicts)
