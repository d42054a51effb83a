"""Characteristics of deadband compensation with and without hysteresis: Figures 4-12 and 4-13 of the thesis."""

from collections.abc import Sequence

import numpy as np

from hydrohil.claims.study import Curve, Panel, Studied
from hydrohil.claims.trace import Reals, Trace
from hydrohil.experiment.sections import DOWN_UP_GAINS
from hydrohil.services.controller.laws.deadband import deadband_compensation
from hydrohil.services.controller.laws.hysteresis import relay_sign
from hydrohil.shared.units import A_PER_MA
from hydrohil.thesis.readings import above, printed

SHOWN_MA = 30.0
_FUNCTION = 'thesis 4.5.1: "Using this function (with U_L = 7mA, U_+ = -U_- = 88mA)"'
_THRESHOLD = (
    'thesis 4.5.1: "The aim of this method was to eliminate the effects of overlap in the spool valve. Based on the observation '
    'that the control signal always had to exceed a threshold of ~88mA in absolute value before motion occurred"'
)


def compensation_ma(current_ma: Reals) -> Reals:
    """(n,) what deadband compensation adds to a control signal of link 2."""
    return np.array([deadband_compensation(DOWN_UP_GAINS, u * A_PER_MA) for u in current_ma.tolist()]) / A_PER_MA


def relay_ma(current_ma: Reals) -> Reals:
    """(n,) what the compensation with hysteresis adds along a path of control signals."""
    sign, found = 0, []
    for u in current_ma.tolist():
        sign = relay_sign(DOWN_UP_GAINS, sign, u * A_PER_MA)
        found.append(sign * (DOWN_UP_GAINS.deadband_positive_a if sign > 0 else DOWN_UP_GAINS.deadband_negative_a))
    return np.array(found) / A_PER_MA


def plain(_: Sequence[Trace]) -> Studied:
    """Figure 4-12: what is added to a current, and what then reaches the valve (4.5.1)."""
    u = np.linspace(-SHOWN_MA, SHOWN_MA, 601)
    added = compensation_ma(u)
    full = np.abs(added) >= np.max(added)
    panels = (Panel("u, mA", "u_c, mA", (Curve("added", u, added), Curve("u + u_c", u, u + added))),)
    verdicts = (
        printed("Compensation beyond U_L", "mA", 88.0, 1.0, float(added[-1]), _FUNCTION),
        printed("Compensation below -U_L", "mA", -88.0, 1.0, float(added[0]), _FUNCTION),
        printed("Control signal from which it is whole", "mA", 7.0, 1.0, float(np.min(np.abs(u[full]))), _FUNCTION),
        above("What reaches the valve beyond U_L exceeds the threshold", "mA", 88.0, np.min(np.abs(u + added)[full]), _THRESHOLD),
    )
    return Studied(panels, verdicts)


def hysteretic(_: Sequence[Trace]) -> Studied:
    """The text of 4.5.2 is lost, and with it every statement: the rig's reading of its title is drawn."""
    up = np.linspace(-SHOWN_MA, SHOWN_MA, 601)
    path = np.concatenate((up, up[::-1]))
    added = relay_ma(path)
    curves = (Curve("rising", up, added[: len(up)]), Curve("falling", up[::-1], added[len(up) :]))
    return Studied((Panel("u, mA", "u_c, mA", curves),), ())
