"""What chapter 4 of the thesis says of each trial, as bands. The text gives few numbers; its words are read once, here.

"Good", "closely", "large" are a tenth of the pattern's size, "excellent", "superior", "greatly improved" a fiftieth,
"improved" a twentieth. Overshoot is visible, and a link at rest off its set-point, from two encoder counts on: the
steady-state error that the text calls the limit of the positioning ability.

"A factor of five" is what rounds to five or more, of the rms error over the whole trial. The sentence sets tracking, the
ramps and the sine, apart from regulation, the steps, which must not have become worse.
"""

from hydrohil.claims.bands import Measure, at_least, at_most, between
from hydrohil.claims.claims import Claim
from hydrohil.claims.pairs import PairClaim
from hydrohil.claims.signals import COUNT_Q
from hydrohil.shared.units import RAD_PER_DEG

LARGE_DEG, SMALL_DEG = 20.0, 1.0  # size of the large patterns and of the small step
START_S = 0.1  # the patterns begin here: Figure 4-14 shows the first second of a small ramp, broken loose at 0.9 s
THERE_S = 5.0  # up to here the first half: there; the rest: back
SINE_DEG = 2.0  # first swing of the sine, peak to peak
LARGE_SINE_S, SMALL_SINE_S, SINE_S = 10.0, 16.0, 20.0  # above 1 deg peak to peak; below 0.4 deg
TENTH, TWENTIETH, FIFTIETH = 0.1, 0.05, 0.02
FIVE = 4.5  # rounds to five
TWO_COUNTS_DEG = 2.0 * COUNT_Q[1] / RAD_PER_DEG

_STEADY = (
    'thesis 4.6: "The ramp and step trials show that the steady-state positioning error is about 1 or 2 '
    'encoder resolution widths."'
)
_PI_SINE = 'thesis 4.3: "the complete failure to track the sine wave pattern (Figure 4-6)."'
_RAMP_OVERSHOOT = 'thesis 4.3: "Ramp tests also showed overshoot in the manipulator response."'
_MORSE_OVERSHOOT = 'thesis 4.4: "Finally, overshoot remained in ramp and sine wave tracking."'
_MORSE_RAMPS = (
    'thesis 4.4: "a ten-fold increase in the integral gain ... improving tracking in ramp tests (Figure 4-7 and Figure 4-9)."'
)
_MORSE_SINE = (
    'thesis 4.4: "Figure 4-11, which shows greatly improved sine wave tracking at large amplitudes, '
    'but renewed sticking for small commanded displacements."'
)
_STUCK = (
    'thesis 4.5.3, Figure 4-14, first second of Figure 4-9, static friction broken at 0.9 s: "integral based methods of '
    'stiction compensation rely on the smallest signal. The velocity error provides a much stronger signal."'
)
_DEADBAND_LARGE = 'thesis 4.5.1: "gave excellent trajectory tracking for large displacements."'
_DEADBAND_SMALL = (
    'thesis 4.5.1: "Small control signals caused rapid bang-bang action in the augmentation signal, '
    'inducing oscillations in the system."'
)
_VETIA = 'thesis 4.5.4: "Inspection of the experimental results shows the superior trajectory tracking abilities."'
_VETIA_HARMLESS = 'thesis 4.5.4: "In no test does the proposed method show any detrimental side effects."'
_VETIA_OVERSHOOT = (
    'thesis 4.6: "the same graph shows recurrent large overshoot in tracking a 1Hz sinusoidal input, particularly at '
    'larger amplitudes. The ramp response tests also show this tendency to overshoot."'
)
_FINAL_STEPS = (
    'thesis 4.6: "No negative effects were observed as a result of this modification. The step responses were unaffected."'
)
_FINAL_RAMPS = (
    'thesis 4.6: "reduce the integral when the desired velocity is approaching zero, which is when the problems with '
    'overshoot are observed"; "The same effect provided some improvement in tracking ramp inputs as well."'
)
_DIFFICULTY = (
    'thesis 4.6: "the controller still has difficulty following the sine wave once the peak-to-peak amplitude drops to 0.2 deg."'
)
_SCALLOPED = (
    'thesis 4.6: "The control signal had a scalloped appearance, being diminished by the additional term whenever a '
    'deceleration was specified."'
)
_PI_LARGE_RAMP = 'thesis 4.3: "Trajectory tracking was good for the large ramp (Figure 4-2)."'
_WIND_UP = 'thesis 4.3: "integral wind-up caused expectedly large overshoots in response to large step inputs (Figure 4-3)."'
_DELAYS = 'thesis 4.3: "Delays in motion of up to 2 seconds, due to stiction and actuator deadband, were observed (Figure 4-4)."'
_PI_SMALL_STEP = (
    'thesis 4.3: "Trajectory tracking was good for the large ramp (Figure 4-2) and small step (Figure 4-5) patterns."'
)
_MORSE_LARGE_STEP = 'thesis 4.4: "The nonlinear factor greatly improved the large step response."'
_MORSE_SMALL_STEP = 'thesis 4.4: "it did reduce the overshoot observed for very small changes in position."'
_STICKING_ELIMINATED = (
    'thesis 4.5.3: "practically eliminate sticking"; Figure 4-14: without it static friction is broken at 0.9 s.'
)
_VETIA_SINE = 'thesis 4.6: "Figure 4-20 shows how the proposed method of stiction compensation eliminates sticking."'
_FINAL_SINE = 'thesis 4.6: "The manipulator could now follow the sine wave closely for the larger amplitude oscillations."'


def _rms(words: str, share: float, source: str) -> Claim:
    return at_most(words, Measure("rms_error", "q2", "deg", 0.0, 2.0 * THERE_S), share * LARGE_DEG, source)


def _overshoots(words: str, least_deg: float, source: str) -> Claim:
    return at_least(words, Measure("overshoot", "q2", "deg", 0.0, THERE_S), least_deg, source)


def _no_overshoot(words: str, most_deg: float, source: str) -> Claim:
    return at_most(words, Measure("overshoot", "q2", "deg", 0.0, THERE_S), most_deg, source)


def _swings(start_s: float, end_s: float) -> Measure:
    """How large the sine's swings are, over those of the set-point."""
    return Measure("cycle_ratio", "q2", "1", start_s, end_s)


def _reversals(start_s: float, end_s: float, least: float) -> Claim:
    words = "The control bangs from side to side"
    return at_least(words, Measure("control_reversals", "q2", "counts", start_s, end_s), least, _DEADBAND_SMALL)


def _steady() -> tuple[Claim, ...]:
    there = at_most("It rests within two counts", Measure("steady_error_counts", "q2", "counts", 4.0, THERE_S), 2.0, _STEADY)
    return (there, there._replace(statement="It rests within two counts, back", start_s=9.0, end_s=2.0 * THERE_S))


_PI = {
    "pi-large-ramp": (
        _rms("The large ramp is tracked well", TENTH, _PI_LARGE_RAMP),
        _overshoots("The ramp's end is overshot", TWO_COUNTS_DEG, _RAMP_OVERSHOOT),
    ),
    "pi-large-step": (_overshoots("Integral wind-up overshoots far", TENTH * LARGE_DEG, _WIND_UP),),
    "pi-small-ramp": (
        between("Motion is delayed by up to 2 s", Measure("longest_delay_s", "q2", "s", 0.0, 2.0 * THERE_S), 1.5, 2.5, _DELAYS),
        _overshoots("The ramp's end is overshot", TWO_COUNTS_DEG, _RAMP_OVERSHOOT),
    ),
    "pi-small-step": (
        at_most(
            "The small step is tracked well", Measure("max_error", "q2", "deg", 4.0, THERE_S), TENTH * SMALL_DEG, _PI_SMALL_STEP
        ),
    ),
    "pi-sine": (
        at_least(
            "The sine is not tracked: the error is as large as the signal",
            Measure("relative_error", "q2", "%", 0.0, SINE_S),
            90.0,
            _PI_SINE,
        ),
        at_most("Not half of the motion takes place", _swings(0.0, SINE_S), 0.5, _PI_SINE),
    ),
}
_MORSE = {
    "morse-large-ramp": (
        _rms("Tracking of the ramp is improved", TWENTIETH, _MORSE_RAMPS),
        _overshoots("The ramp's end is overshot", TWO_COUNTS_DEG, _MORSE_OVERSHOOT),
    ),
    "morse-large-step": (_no_overshoot("The integral no longer winds up", FIFTIETH * LARGE_DEG, _MORSE_LARGE_STEP),),
    "morse-small-ramp": (
        between("Static friction is broken at 0.9 s", Measure("first_motion_s", "q2", "s", 0.0, 2.0), 0.8, 1.0, _STUCK),
        at_least(
            "In stiction the velocity error is larger than the position error",
            Measure("error_rate_to_error", "q2", "1/s", 0.0, 0.9),
            1.0,
            _STUCK,
        ),
        at_most(
            "In stiction the error's integral is smaller than the error",
            Measure("error_integral_to_error", "q2", "s", 0.0, 0.9),
            1.0,
            _STUCK,
        ),
        _overshoots("The ramp's end is overshot", TWO_COUNTS_DEG, _MORSE_OVERSHOOT),
    ),
    "morse-small-step": (_no_overshoot("A small step is not overshot", TWO_COUNTS_DEG, _MORSE_SMALL_STEP),),
    "morse-sine": (
        at_least("Large swings are followed", _swings(0.0, LARGE_SINE_S), 1.0 - TENTH, _MORSE_SINE),
        at_least(
            "The largest swing is overshot",
            Measure("peak_to_peak_ratio", "q2", "1", 0.0, LARGE_SINE_S),
            1.0 + TWO_COUNTS_DEG / SINE_DEG,
            _MORSE_OVERSHOOT,
        ),
        at_most("Small swings stick", _swings(SMALL_SINE_S, SINE_S), 0.5, _MORSE_SINE),
    ),
}
_DEADBAND = {
    "deadband-large-ramp": (_rms("The large ramp is tracked excellently", FIFTIETH, _DEADBAND_LARGE),),
    "deadband-large-step": (_no_overshoot("The large step is not overshot", FIFTIETH * LARGE_DEG, _DEADBAND_LARGE),),
    "deadband-small-ramp": (_reversals(0.0, 2.0 * THERE_S, 10.0),),  # rapid: once a second; the pattern needs two
    "deadband-small-step": (_reversals(0.0, 2.0 * THERE_S, 10.0),),
    "deadband-sine": (_reversals(SMALL_SINE_S, SINE_S, 16.0),),  # twice what the sine itself asks for
}
_VETIA_CLAIMS = {
    "vetia-large-ramp": (
        _rms("The large ramp is tracked very well", FIFTIETH, _VETIA),
        _overshoots("The ramp's end is overshot", TWO_COUNTS_DEG, _VETIA_OVERSHOOT),
    ),
    "vetia-large-step": (_no_overshoot("The step response has not suffered", FIFTIETH * LARGE_DEG, _VETIA_HARMLESS),),
    "vetia-small-ramp": (
        at_most(
            "The link breaks loose sooner than by Morse's method",
            Measure("first_motion_s", "q2", "s", 0.0, THERE_S),
            0.8,
            _STICKING_ELIMINATED,
        ),
        _overshoots("The ramp's end is overshot", TWO_COUNTS_DEG, _VETIA_OVERSHOOT),
    ),
    "vetia-small-step": (_no_overshoot("The step response has not suffered", TWO_COUNTS_DEG, _VETIA_HARMLESS),),
    "vetia-sine": (
        at_least("Large swings are overshot far", _swings(0.0, LARGE_SINE_S), 1.0 + TENTH, _VETIA_OVERSHOOT),
        at_least("Small swings do not stick", _swings(SMALL_SINE_S, SINE_S), 0.5, _VETIA_SINE),
    ),
}
_FINAL = {
    "final-large-ramp": (
        _rms("The large ramp is tracked very well", FIFTIETH, _FINAL_RAMPS),
        _no_overshoot("The ramp's end is not overshot", TWO_COUNTS_DEG, _FINAL_RAMPS),
        *_steady(),
    ),
    "final-large-step": (_no_overshoot("The step response is unaffected", FIFTIETH * LARGE_DEG, _FINAL_STEPS), *_steady()),
    "final-small-ramp": (_no_overshoot("The ramp's end is not overshot", TWO_COUNTS_DEG, _FINAL_RAMPS), *_steady()),
    "final-small-step": (_no_overshoot("The step response is unaffected", TWO_COUNTS_DEG, _FINAL_STEPS), *_steady()),
    "final-sine": (
        between("Large swings are followed closely", _swings(0.0, LARGE_SINE_S), 1.0 - TENTH, 1.0 + TENTH, _FINAL_SINE),
        between("The last swing above 0.2 deg peak to peak is followed", _swings(17.2, 18.3), 0.5, 1.5, _DIFFICULTY),
        at_least(
            "Below 0.2 deg peak to peak it has difficulty", Measure("relative_error", "q2", "%", 18.0, SINE_S), 50.0, _DIFFICULTY
        ),
        at_most(
            "The control is weaker while the set-point brakes",
            Measure("braking_control_ratio", "q2", "1", 0.0, LARGE_SINE_S),
            1.0,
            _SCALLOPED,
        ),
    ),
}
CLAIMS: dict[str, tuple[Claim, ...]] = {**_PI, **_MORSE, **_DEADBAND, **_VETIA_CLAIMS, **_FINAL}

_FACTOR = (
    'thesis abstract: "improve position tracking accuracy on an existing industrial hydraulic manipulator by a factor of '
    'five relative to an optimized linear PI controller, without sacrificing regulation accuracy or robustness."'
)


def _against_pi(words: str, pi: str, final: str, end_s: float, least: float) -> PairClaim:
    return PairClaim(
        words,
        of=pi,
        against=final,
        measure="metric_ratio",
        channel="q2",
        comparison="above",
        start_s=0.0,
        end_s=end_s,
        unit="1",
        metric="rms_error",
        low=least,
        source=_FACTOR,
    )


PAIRS: tuple[PairClaim, ...] = (
    _against_pi("PI's error on the large ramp is five times as large", "fig-4-2", "fig-4-21", 2.0 * THERE_S, FIVE),
    _against_pi("PI's error on the small ramp is five times as large", "fig-4-4", "fig-4-23", 2.0 * THERE_S, FIVE),
    _against_pi("PI's error on the sine is five times as large", "fig-4-6", "fig-4-25", SINE_S, FIVE),
    _against_pi("Regulation of the large step is not sacrificed", "fig-4-3", "fig-4-22", 2.0 * THERE_S, 1.0),
    _against_pi("Regulation of the small step is not sacrificed", "fig-4-5", "fig-4-24", 2.0 * THERE_S, 1.0),
)
