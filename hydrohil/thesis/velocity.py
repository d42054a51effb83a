"""Velocity by linear regression over N encoder readings: noise, lag and distortion (thesis Appendix B)."""

from collections.abc import Sequence

import numpy as np

from hydrohil.claims.signals import COUNT_Q, rms
from hydrohil.claims.study import Curve, Panel, Studied
from hydrohil.claims.trace import Reals, Trace
from hydrohil.services.controller.regression import POINTS, filled_window, push, velocities
from hydrohil.shared.units import NS_PER_S, RAD_PER_DEG
from hydrohil.thesis.readings import HALF, TENTH, about, above, below

COUNTS = (2, 5, 10, 20, 40, 100)  # points, Figure 9-8 a to f
PERIOD_S = 1.0 / 200.0  # Appendix B
AMPLITUDE_DEG = 10.0  # Appendix B
RESOLUTION_DEG = 0.28  # Appendix B; ten times the robot's, 4.2
OWN_RESOLUTION_DEG = COUNT_Q[1] / RAD_PER_DEG
QUARTER_S = 1.0  # the text does not say; chosen: the largest speed is then 15.7 deg/s

_SPIKES = 'thesis Appendix B: "The impulse behaviour previously described is clearly visible when using a 2-point regression."'
_FALSE_ZERO = (
    'thesis Appendix B: "In the limiting case of a 2-point regression, this phenomenon will result in the calculation of a '
    'false, zero velocity for the second such point."'
)
_TEN = 'thesis Appendix B: "Much oscillation is present even with a 10 point regression."'
_TWENTY = (
    'thesis Appendix B: "The derived velocity profile is reasonably smooth using a 20 point regression, but a more '
    'noticeable lag is introduced. This lag increases as more points are used in the regression."'
)
_HUNDRED = (
    'thesis Appendix B: "Eventually, at 100 points, excessive smoothing has greatly distorted the character of the velocity '
    'profile."'
)


def profile_times_s() -> Reals:
    """(n,) sampling times of the test profile, from 0 to the end of the quarter wave."""
    return np.asarray(np.arange(round(QUARTER_S / PERIOD_S) + 1, dtype=np.float64) * PERIOD_S)


def position_deg(times_s: Reals) -> Reals:
    """A quarter of a cosine from rest:  10 deg (1 - cos(pi t / 2 T)), zero for negative time (Figure 9-7)."""
    phase = np.pi / 2.0 * np.maximum(times_s, 0.0) / QUARTER_S
    return np.asarray(AMPLITUDE_DEG * (1.0 - np.cos(phase)))


def velocity_deg_per_s(times_s: Reals) -> Reals:
    """Velocity of that profile, the derivative of `position_deg`."""
    rate = np.pi / 2.0 / QUARTER_S
    return np.asarray(AMPLITUDE_DEG * rate * np.sin(rate * np.maximum(times_s, 0.0)))


def digitised_deg(angles_deg: Reals, resolution_deg: float) -> Reals:
    """What a counter of that resolution reads; 0 leaves the angles as they are."""
    return np.floor(angles_deg / resolution_deg) * resolution_deg if resolution_deg > 0.0 else angles_deg


def weights_per_s(points: int, period_s: float) -> Reals:
    """(points,) of the regression's slope over evenly spaced readings, oldest first."""
    t = (np.arange(points) - (points - 1) / 2.0) * period_s
    return np.asarray(t / np.sum(t * t))


def regressed_deg_per_s(points: int, resolution_deg: float) -> Reals:
    """(n,) slope of the last `points` readings at each sample, the link standing at zero before the first."""
    readings = digitised_deg(position_deg(profile_times_s()), resolution_deg)
    if points == POINTS:
        return controller_deg_per_s(readings)
    padded = np.concatenate((np.full(points - 1, readings[0]), readings))
    return np.convolve(padded, weights_per_s(points, PERIOD_S)[::-1], mode="valid")


def controller_deg_per_s(readings_deg: Reals) -> Reals:
    """(n,) the same by the controller's own kernels, which hold 20 readings."""
    period_ns = round(PERIOD_S * NS_PER_S)
    window, found = filled_window(-period_ns, (float(readings_deg[0]),) * 3, period_ns), []
    for number, reading in enumerate(readings_deg.tolist()):
        window = push(window, number * period_ns, (reading,) * 3, (0.0, 0.0, 0.0))
        found.append(velocities(window)[0][0])
    return np.array(found)


def noise_deg_per_s(points: int, resolution_deg: float) -> Reals:
    """(m,) what the encoder's resolution adds to the slope, once the window is inside the motion."""
    return (regressed_deg_per_s(points, resolution_deg) - regressed_deg_per_s(points, 0.0))[points:]


def lag_s(points: int) -> float:
    """Time by which the slope follows the undigitised profile: the phase of its sine once the window is inside the motion."""
    times, rate = profile_times_s()[points:], np.pi / 2.0 / QUARTER_S
    waves = np.column_stack((np.sin(rate * times), np.cos(rate * times)))
    along, behind = np.linalg.lstsq(waves, regressed_deg_per_s(points, 0.0)[points:])[0]
    return float(np.arctan2(-behind, along) / rate)


def distortion(points: int) -> float:
    """rms of slope minus velocity over the rms of the velocity, undigitised."""
    true = velocity_deg_per_s(profile_times_s())
    return rms(regressed_deg_per_s(points, 0.0) - true) / rms(true)


def position_study(_: Sequence[Trace]) -> Studied:
    """Figure 9-7: the profile, and what the encoder makes of it."""
    times = profile_times_s()
    actual = position_deg(times)
    curves = (
        Curve("actual", times, actual),
        Curve("digitised", times, digitised_deg(actual, RESOLUTION_DEG)),
        Curve("digitised as by the robot", times, digitised_deg(actual, OWN_RESOLUTION_DEG)),
    )
    steps = len(np.unique(digitised_deg(actual, RESOLUTION_DEG))) - 1
    source = (
        'thesis Appendix B: "A position trajectory was generated using a quarter cosine wave of amplitude 10 degrees. An '
        'encoder resolution of 0.28 degrees and sampling rate of 200 Hz were assumed"'
    )
    # 10 deg hold 35.7 widths
    verdict = about("The profile crosses as many counts as fit into 10 deg", "counts", 35.0, 0.0, float(steps), source)
    return Studied((Panel("time, s", "position, deg", curves),), (verdict,))


def velocity_study(_: Sequence[Trace]) -> Studied:
    """Figure 9-8: velocities by 2 to 100 points beside the true one."""
    times = profile_times_s()
    true = velocity_deg_per_s(times)
    panels = tuple(
        Panel(
            "time, s",
            "velocity, deg/s",
            (
                Curve("actual", times, true),
                Curve("0.28 deg", times, regressed_deg_per_s(points, RESOLUTION_DEG)),
                Curve("0.028 deg", times, regressed_deg_per_s(points, OWN_RESOLUTION_DEG)),
            ),
            title=f"{points} points",
        )
        for points in COUNTS
    )
    fastest = float(np.max(true))
    two = regressed_deg_per_s(2, RESOLUTION_DEG)[2:]
    ten, twenty = (100.0 * rms(noise_deg_per_s(points, RESOLUTION_DEG)) / rms(true) for points in (10, 20))
    zeros = 100.0 * float(np.mean(two == 0.0))
    lags = np.array([lag_s(points) for points in COUNTS])
    half_window_s = (20 - 1) * PERIOD_S / 2.0
    verdicts = (
        above("2 points: spikes beyond the velocity by half of it or more", "1", 1.0 + HALF, np.max(two) / fastest, _SPIKES),
        above("2 points: a moving link reads zero, most of the time", "%", 100.0 * HALF, zeros, _FALSE_ZERO),
        above("10 points: much oscillation, rms over that of the velocity", "%", 100.0 * TENTH, ten, _TEN),
        below("20 points: reasonably smooth, rms over that of the velocity", "%", 100.0 * TENTH, twenty, _TWENTY),
        about("20 points: lag, half the window", "s", half_window_s, TENTH, lags[COUNTS.index(20)], _TWENTY),
        above("The lag grows with every step in points", "s", PERIOD_S, float(np.min(np.diff(lags))), _TWENTY),
        above("100 points: greatly distorted", "%", 100.0 * TENTH, 100.0 * distortion(100), _HUNDRED),
    )
    return Studied(panels, verdicts)
