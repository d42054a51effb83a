"""What position laws beyond the thesis must show against its own results, from the sentences that ask for them.

A law is better from a twentieth on, as "improved" is read in chapter 4, and not worse up to a twentieth. Small are the
small ramp and the sine below 0.4 deg peak to peak; a control has stopped oscillating, which was four swings or more in the
two seconds of Figure 5-8, if it goes to the other side once and comes back: two swings, half as many.
"""

from hydrohil.claims.bands import Measure, at_most, between
from hydrohil.claims.claims import Claim
from hydrohil.claims.metrics import MetricName
from hydrohil.claims.pairs import PairClaim
from hydrohil.thesis import claims4, claims5

BETTER, NOT_WORSE = 1.0 - claims4.TWENTIETH, 1.0 + claims4.TWENTIETH
THERE_AND_BACK = 2.0  # swings
HALF = 0.5
RISING_S = (5.0, 10.0)  # the force falls, the tool rises; a second time ten seconds later
RISING_AGAIN_S = (15.0, 20.0)
WORST_S = (7.0, 9.0)  # "best seen between 7 and 9 seconds in Figure 5-8"
FORCE_FIGURES = ("fig-5-5", "fig-5-6", "fig-5-7", "fig-5-8")

_ROBUST = (
    'thesis 9.2.1: "Figure 4-25 shows that, in order to have good tracking at larger velocities, the overshoot reduction is '
    'insufficient at low velocities. Perhaps a velocity-dependent gain, or another method altogether, might prove more robust."'
)
_AWARE = (
    'thesis 9.2.2: "it had difficulty with fine control of motions when the required actuator torque opposed the direction of '
    "motion. ... These joint torques could then be incorporated into the control signal, either by direct feedforward or "
    'through a more sophisticated technique."'
)
_KEPT = (
    'thesis 9.2.2: "In order to extend the excellent trajectory-tracking abilities of the position controller to this scenario"'
)


_OVERSHOT = (
    'thesis 9.2.2: "The correct direction of motion was still obtained, but the trajectory exhibited overshoot, especially for '
    'small commanded displacements."'
)


def _final(pattern: str) -> tuple[Claim, ...]:
    """What is stated of the final law, but not its difficulty with the smallest swings."""
    return tuple(claim for claim in claims4.CLAIMS[f"final-{pattern}"] if claim.metric != "relative_error")


_SMALL_S = (claims4.SMALL_SINE_S, claims4.SINE_S)
_SMALL_SWINGS = between(
    "Small swings neither stick nor overshoot", Measure("cycle_ratio", "q2", "1", *_SMALL_S), HALF, 1.0, _ROBUST
)


def _against(words: str, of: str, figure: str, metric: MetricName, window_s: tuple[float, float], most: float) -> PairClaim:
    return PairClaim(
        words,
        of=of,
        against=figure,
        measure="metric_ratio",
        channel="q2",
        comparison="below",
        start_s=window_s[0],
        end_s=window_s[1],
        unit="1",
        metric=metric,
        high=most,
        source=_ROBUST if of.startswith("robust") else _AWARE,
    )


def _trajectory(of: str, figure: str) -> PairClaim:
    words = "The link's trajectory is followed better, moving up"
    return _against(words, of, figure, "rms_error", RISING_S, BETTER)._replace(source=_OVERSHOT)


def _force(of: str, figure: str) -> PairClaim:
    claim = _against("The force is followed no worse", of, figure, "rms_error", (0.0, claims5.END_S), NOT_WORSE)
    return claim._replace(channel="force", source=_KEPT)


def _quiet(window_s: tuple[float, float]) -> Claim:
    words = "The control no longer oscillates while moving up"
    return at_most(words, Measure("control_swings", "q2", "counts", *window_s), THERE_AND_BACK, _AWARE)


_ALIKE = at_most(
    "Moving up, the control swings no more than moving down",
    Measure("upward_swing_ratio", "q2", "1", 0.0, claims5.END_S),
    1.0,
    _AWARE,
)
_TRACKED, _SMALL_MOTION = claims5.CLAIMS["fig-5-7"], claims5.CLAIMS["fig-5-8"][:2]
CLAIMS: dict[str, tuple[Claim, ...]] = {
    **{f"robust-{pattern}": _final(pattern) for pattern in ("large-ramp", "large-step", "small-ramp", "small-step")},
    "robust-sine": (*_final("sine"), _SMALL_SWINGS),
    "torque-static-force-soft-plate": claims5.CLAIMS["fig-5-5"],
    "torque-static-force-stiff-plate": claims5.CLAIMS["fig-5-6"],
    "torque-dynamic-force-soft-plate": (*_TRACKED, _quiet(RISING_S), _ALIKE),
    "torque-dynamic-force-stiff-plate": (*_SMALL_MOTION, _quiet(WORST_S), _ALIKE),
}

_PATTERN_S = (0.0, 2.0 * claims4.THERE_S)
_LARGE_S = (0.0, claims4.LARGE_SINE_S)
_SOFT, _STIFF = ("torque-dynamic-force-soft-plate", "fig-5-7"), ("torque-dynamic-force-stiff-plate", "fig-5-8")
PAIRS: tuple[PairClaim, ...] = (
    _against("The small ramp is overshot less", "robust-small-ramp", "fig-4-23", "overshoot", (0.0, claims4.THERE_S), BETTER),
    _against("The small ramp is tracked no worse", "robust-small-ramp", "fig-4-23", "rms_error", _PATTERN_S, NOT_WORSE),
    _against("Small swings of the sine are smaller", "robust-sine", "fig-4-25", "cycle_ratio", _SMALL_S, BETTER),
    _against("Small swings of the sine are tracked better", "robust-sine", "fig-4-25", "rms_error", _SMALL_S, BETTER),
    _against("Large swings of the sine are tracked no worse", "robust-sine", "fig-4-25", "rms_error", _LARGE_S, NOT_WORSE),
    _against("The large ramp is tracked no worse", "robust-large-ramp", "fig-4-21", "rms_error", _PATTERN_S, NOT_WORSE),
    _against("The large step is answered no worse", "robust-large-step", "fig-4-22", "rms_error", _PATTERN_S, NOT_WORSE),
    _against("The small step is answered no worse", "robust-small-step", "fig-4-24", "rms_error", _PATTERN_S, NOT_WORSE),
    _against("The control swings half as often, moving up", *_SOFT, "control_swings", RISING_S, HALF),
    _against("The control swings half as often, moving up again", *_SOFT, "control_swings", RISING_AGAIN_S, HALF),
    _trajectory(*_SOFT),
    _force(*_SOFT),
    _against("The control swings half as often, moving up", *_STIFF, "control_swings", WORST_S, HALF),
    _against("The control swings half as often, moving up again", *_STIFF, "control_swings", RISING_AGAIN_S, HALF),
    _trajectory(*_STIFF),
    _force(*_STIFF),
)
