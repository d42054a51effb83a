"""What chapter 4 of the thesis says of each trial, as bands. The text gives few numbers; its words are read once, here.

"Good", "closely", "large" are a tenth of the pattern's size, "excellent", "superior", "greatly improved" a fiftieth,
"improved" a twentieth. Overshoot is visible, and a link at rest off its set-point, from two encoder counts on: the
steady-state error that the text calls the limit of the positioning ability.

"A factor of five" is what rounds to five or more, of the rms error over the whole trial. The sentence sets tracking, the
ramps and the sine, apart from regulation, the steps, which must not have become worse.
"""

from hydrohil.claims.claims import Claim, Comparison
from hydrohil.claims.pairs import PairClaim
from hydrohil.claims.signals import COUNT_RAD
from hydrohil.shared.units import RAD_PER_DEG

LARGE_DEG, SMALL_DEG = 20.0, 1.0  # size of the large patterns and of the small step
START_S = 0.1  # the patterns begin here: Figure 4-14 shows the first second of a small ramp, broken loose at 0.9 s
THERE_S = 5.0  # up to here the first half: there; the rest: back
SINE_DEG = 2.0  # first swing of the sine, peak to peak
LARGE_SINE_S, SMALL_SINE_S, SINE_S = 10.0, 16.0, 20.0  # above 1 deg peak to peak; below 0.4 deg
TENTH, TWENTIETH, FIFTIETH = 0.1, 0.05, 0.02
FIVE = 4.5  # rounds to five
TWO_COUNTS_DEG = 2.0 * COUNT_RAD[1] / RAD_PER_DEG

_STEADY = (
    'thesis 4.6: "The ramp and step trials show that the steady-state positioning error is about 1 or 2 '
    'encoder resolution widths."'
)
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


def _rms(words: str, share: float, source: str) -> Claim:
    return Claim(words, "rms_error", "q2", "below", 0.0, 2.0 * THERE_S, "deg", high=share * LARGE_DEG, source=source)


def _overshoots(words: str, least_deg: float, source: str) -> Claim:
    return Claim(words, "overshoot", "q2", "above", 0.0, THERE_S, "deg", low=least_deg, source=source)


def _no_overshoot(words: str, most_deg: float, source: str) -> Claim:
    return Claim(words, "overshoot", "q2", "below", 0.0, THERE_S, "deg", high=most_deg, source=source)


def _sine_ratio(words: str, comparison: Comparison, start_s: float, end_s: float, low: float, high: float, source: str) -> Claim:
    claim = Claim(words, "cycle_ratio", "q2", "within", start_s, end_s, "1", low=low, high=high, source=source)
    return claim._replace(comparison=comparison)


def _reversals(start_s: float, end_s: float, least: float) -> Claim:
    words = "The control bangs from side to side"
    return Claim(words, "control_reversals", "q2", "above", start_s, end_s, "counts", low=least, source=_DEADBAND_SMALL)


def _steady() -> tuple[Claim, ...]:
    there = Claim(
        "It rests within two counts", "steady_error_counts", "q2", "below", 4.0, THERE_S, "counts", high=2.0, source=_STEADY
    )
    return (there, there._replace(statement="It rests within two counts, back", start_s=9.0, end_s=2.0 * THERE_S))


_PI = {
    "pi-large-ramp": (
        _rms(
            "The large ramp is tracked well", TENTH, 'thesis 4.3: "Trajectory tracking was good for the large ramp (Figure 4-2)."'
        ),
        _overshoots("The ramp's end is overshot", TWO_COUNTS_DEG, _RAMP_OVERSHOOT),
    ),
    "pi-large-step": (
        _overshoots(
            "Integral wind-up overshoots far",
            TENTH * LARGE_DEG,
            'thesis 4.3: "integral wind-up caused expectedly large overshoots in response to large step inputs (Figure 4-3)."',
        ),
    ),
    "pi-small-ramp": (
        Claim(
            "Motion is delayed by up to 2 s",
            "longest_delay_s",
            "q2",
            "within",
            0.0,
            2.0 * THERE_S,
            "s",
            low=1.5,
            high=2.5,
            source='thesis 4.3: "Delays in motion of up to 2 seconds, due to stiction and actuator deadband, were '
            'observed (Figure 4-4)."',
        ),
        _overshoots("The ramp's end is overshot", TWO_COUNTS_DEG, _RAMP_OVERSHOOT),
    ),
    "pi-small-step": (
        Claim(
            "The small step is tracked well",
            "max_error",
            "q2",
            "below",
            4.0,
            THERE_S,
            "deg",
            high=TENTH * SMALL_DEG,
            source='thesis 4.3: "Trajectory tracking was good for the large ramp (Figure 4-2) and small step (Figure '
            '4-5) patterns."',
        ),
    ),
    "pi-sine": (
        Claim(
            "The sine is not tracked: the error is as large as the signal",
            "relative_error",
            "q2",
            "above",
            0.0,
            SINE_S,
            "%",
            low=90.0,
            source='thesis 4.3: "the complete failure to track the sine wave pattern (Figure 4-6)."',
        ),
        _sine_ratio(
            "Not half of the motion takes place",
            "below",
            0.0,
            SINE_S,
            0.0,
            0.5,
            'thesis 4.3: "the complete failure to track the sine wave pattern (Figure 4-6)."',
        ),
    ),
}
_MORSE = {
    "morse-large-ramp": (
        _rms("Tracking of the ramp is improved", TWENTIETH, _MORSE_RAMPS),
        _overshoots("The ramp's end is overshot", TWO_COUNTS_DEG, _MORSE_OVERSHOOT),
    ),
    "morse-large-step": (
        _no_overshoot(
            "The integral no longer winds up",
            FIFTIETH * LARGE_DEG,
            'thesis 4.4: "The nonlinear factor greatly improved the large step response."',
        ),
    ),
    "morse-small-ramp": (
        Claim(
            "Static friction is broken at 0.9 s",
            "first_motion_s",
            "q2",
            "within",
            0.0,
            2.0,
            "s",
            low=0.8,
            high=1.0,
            source=_STUCK,
        ),
        Claim(
            "In stiction the velocity error is larger than the position error",
            "error_rate_to_error",
            "q2",
            "above",
            0.0,
            0.9,
            "1/s",
            low=1.0,
            source=_STUCK,
        ),
        Claim(
            "In stiction the error's integral is smaller than the error",
            "error_integral_to_error",
            "q2",
            "below",
            0.0,
            0.9,
            "s",
            high=1.0,
            source=_STUCK,
        ),
        _overshoots("The ramp's end is overshot", TWO_COUNTS_DEG, _MORSE_OVERSHOOT),
    ),
    "morse-small-step": (
        _no_overshoot(
            "A small step is not overshot",
            TWO_COUNTS_DEG,
            'thesis 4.4: "it did reduce the overshoot observed for very small changes in position."',
        ),
    ),
    "morse-sine": (
        _sine_ratio("Large swings are followed", "above", 0.0, LARGE_SINE_S, 1.0 - TENTH, 0.0, _MORSE_SINE),
        Claim(
            "The largest swing is overshot",
            "peak_to_peak_ratio",
            "q2",
            "above",
            0.0,
            LARGE_SINE_S,
            "1",
            low=1.0 + TWO_COUNTS_DEG / SINE_DEG,
            source=_MORSE_OVERSHOOT,
        ),
        _sine_ratio("Small swings stick", "below", SMALL_SINE_S, SINE_S, 0.0, 0.5, _MORSE_SINE),
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
        Claim(
            "The link breaks loose sooner than by Morse's method",
            "first_motion_s",
            "q2",
            "below",
            0.0,
            THERE_S,
            "s",
            high=0.8,
            source='thesis 4.5.3: "practically eliminate sticking"; Figure 4-14: without it static friction is broken at 0.9 s.',
        ),
        _overshoots("The ramp's end is overshot", TWO_COUNTS_DEG, _VETIA_OVERSHOOT),
    ),
    "vetia-small-step": (_no_overshoot("The step response has not suffered", TWO_COUNTS_DEG, _VETIA_HARMLESS),),
    "vetia-sine": (
        _sine_ratio("Large swings are overshot far", "above", 0.0, LARGE_SINE_S, 1.0 + TENTH, 0.0, _VETIA_OVERSHOOT),
        _sine_ratio(
            "Small swings do not stick",
            "above",
            SMALL_SINE_S,
            SINE_S,
            0.5,
            0.0,
            'thesis 4.6: "Figure 4-20 shows how the proposed method of stiction compensation eliminates sticking."',
        ),
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
        _sine_ratio(
            "Large swings are followed closely",
            "within",
            0.0,
            LARGE_SINE_S,
            1.0 - TENTH,
            1.0 + TENTH,
            'thesis 4.6: "The manipulator could now follow the sine wave closely for the larger amplitude oscillations."',
        ),
        _sine_ratio(
            "The last swing above 0.2 deg peak to peak is followed",
            "within",
            17.2,
            18.3,
            0.5,
            1.5,
            'thesis 4.6: "the controller still has difficulty following the sine wave once the peak-to-peak '
            'amplitude drops to 0.2 deg."',
        ),
        Claim(
            "Below 0.2 deg peak to peak it has difficulty",
            "relative_error",
            "q2",
            "above",
            18.0,
            SINE_S,
            "%",
            low=50.0,
            source='thesis 4.6: "the controller still has difficulty following the sine wave once the peak-to-peak '
            'amplitude drops to 0.2 deg."',
        ),
        Claim(
            "The control is weaker while the set-point brakes",
            "braking_control_ratio",
            "q2",
            "below",
            0.0,
            LARGE_SINE_S,
            "1",
            high=1.0,
            source='thesis 4.6: "The control signal had a scalloped appearance, being diminished by the additional term '
            "whenever a "
            'deceleration was specified."',
        ),
    ),
}
CLAIMS: dict[str, tuple[Claim, ...]] = {**_PI, **_MORSE, **_DEADBAND, **_VETIA_CLAIMS, **_FINAL}

_FACTOR = (
    'thesis abstract: "improve position tracking accuracy on an existing industrial hydraulic manipulator by a factor of '
    'five relative to an optimized linear PI controller, without sacrificing regulation accuracy or robustness."'
)


def _against_pi(words: str, pi: str, final: str, end_s: float, least: float) -> PairClaim:
    ratio = PairClaim(words, pi, final, "metric_ratio", "q2", "above", 0.0, end_s, "1", "rms_error", source=_FACTOR)
    return ratio._replace(low=least)


PAIRS: tuple[PairClaim, ...] = (
    _against_pi("PI's error on the large ramp is five times as large", "fig-4-2", "fig-4-21", 2.0 * THERE_S, FIVE),
    _against_pi("PI's error on the small ramp is five times as large", "fig-4-4", "fig-4-23", 2.0 * THERE_S, FIVE),
    _against_pi("PI's error on the sine is five times as large", "fig-4-6", "fig-4-25", SINE_S, FIVE),
    _against_pi("Regulation of the large step is not sacrificed", "fig-4-3", "fig-4-22", 2.0 * THERE_S, 1.0),
    _against_pi("Regulation of the small step is not sacrificed", "fig-4-5", "fig-4-24", 2.0 * THERE_S, 1.0),
)
