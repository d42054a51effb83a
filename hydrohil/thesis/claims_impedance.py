"""What 9.3.1 and 9.3.4 of the thesis expect of a quieter gauge and of an impedance that adapts, as bands.

"Smooth": while the set-point rests, the control never goes from side to side and the link rests within the two counts of its
positioning ability. A threshold holds for the reading, noise included. "No more" allows a tenth.
"""

from hydrohil.claims.bands import Measure, at_least, at_most
from hydrohil.claims.claims import Claim
from hydrohil.claims.pairs import PairClaim
from hydrohil.thesis.claims5 import CLAIMS as CHAPTER_5

CIRCLE_END_S = 32.0
REST_END_S = 20.0
CEILING_N = 100.0
NO_MORE = 1.1

_SMOOTH = (
    'thesis 9.3.1: "Presently, the high level of noise in the force sensor reading requires a target mass of at least 50kg '
    'for a smooth response."'
)
_FILTER = (
    'thesis 9.3.1: "if some industrially feasible hardware modification or filtering method were implemented, it would allow '
    'the controller to be tested using both faster target dynamics and lower target stiffnesses."'
)
_TRANSIENT = (
    'thesis 9.3.1: "It would be interesting to see how small of a transient response could be obtained in the interrupted '
    'circular trajectory test of Section 5.5."'
)
_CONSTRAINT = (
    'thesis 9.3.1: "However, even with a successful reduction in noise, the fundamental constraints on the selection of '
    'stiffness would remain."'
)
_LIMIT = (
    'thesis 9.3.4: "the task of limiting the forces incurred in the trial of Section 5.5 to below an absolute threshold could '
    "be attempted by: a) adaptively modulating the target stiffness, b) adaptively modulating an offset to the position "
    'set-point, or c) implementing a target impedance with a nonlinear "limit switch"-like spring."'
)
_CONTRAST = 'thesis 9.3.4: "The advantages and disadvantages of the different techniques could be contrasted"'


def _at_rest(source: str) -> tuple[Claim, ...]:
    """The set-point rests; so must control and link."""
    reversals = Measure("control_reversals", "q2", "counts", 0.0, REST_END_S)
    return (
        at_most("The control does not go from side to side", reversals, 0.0, source),
        at_most("The link rests within two counts", reversals._replace(metric="peak_to_peak_counts"), 2.0, source),
    )


SMOOTH, FILTERED = _at_rest(_SMOOTH), _at_rest(_FILTER)
ROUGH = (
    at_least(
        "The noise alone drives the control from side to side",
        Measure("control_reversals", "q2", "counts", 0.0, REST_END_S),
        1.0,
        _SMOOTH,
    ),
)
_PATH = ("maximum", "max_deviation", "departure", "max_modification", "contacts")
PATH = tuple(claim for claim in CHAPTER_5["fig-5-9"] if claim.metric in _PATH)  # what 5.5 says of force, path and bounces
HELD = {True: CHAPTER_5["fig-5-5"], False: CHAPTER_5["fig-5-6"]}  # by soft plate
UNHELD = (at_least("A low target stiffness still cycles", Measure("cycles", "q2", "counts", 10.0, 20.0), 2.0, _CONSTRAINT),)
LIMITED = (
    at_most("The force stays below 100 N", Measure("maximum", "force", "N", 0.0, CIRCLE_END_S), CEILING_N, _LIMIT),
    *(claim for claim in PATH if claim.metric in ("departure", "max_modification")),
)

_RATIO = PairClaim(
    "",
    of="",
    against="",
    measure="metric_ratio",
    channel="z",
    comparison="below",
    start_s=0.0,
    end_s=REST_END_S,
    unit="1",
    metric="setpoint_noise",
    high=1.0,
)


def quieter(of: str, against: str) -> PairClaim:
    """At rest, the set-point of a light filtered target is as smooth as that of 50 kg."""
    return _RATIO._replace(statement="The set-point is as smooth as with 50 kg", of=of, against=against, source=_FILTER)


def noisier(of: str, against: str) -> PairClaim:
    """Without a filter it is not."""
    words = "The set-point is noisier than with 50 kg"
    return _RATIO._replace(statement=words, of=of, against=against, comparison="above", low=1.0, high=0.0, source=_SMOOTH)


def smaller(of: str, against: str) -> tuple[PairClaim, ...]:
    """The circle of 5.5 with a light filtered target against that of the text."""
    transient = _RATIO._replace(of=of, against=against, metric="departure", start_s=4.0, end_s=19.0, source=_TRANSIENT)
    noise = _RATIO._replace(of=of, against=against, start_s=1.0, end_s=3.5, source=_FILTER)
    return (
        transient._replace(statement="The transient is smaller than with 50 kg"),
        noise._replace(statement="Before contact the set-point is as smooth as with 50 kg"),
    )


def price(of: str, against: str) -> tuple[PairClaim, ...]:
    """What a lower peak costs: an adapted target against the one of the text."""
    pair = _RATIO._replace(of=of, against=against, high=NO_MORE, source=_CONTRAST)
    return (
        pair._replace(statement="The peak is lowered", channel="force", metric="maximum", end_s=CIRCLE_END_S, high=1.0),
        pair._replace(statement="It departs no farther from the circle", metric="departure", start_s=4.0, end_s=19.0),
        pair._replace(statement="It is back on the circle as soon", metric="rms_deviation", start_s=12.0, end_s=19.8),
        pair._replace(
            statement="The control reverses no more often in contact",
            channel="q2",
            metric="control_reversals",
            start_s=4.5,
            end_s=10.5,
        ),
        pair._replace(statement="Contact is not lost more often", channel="force", metric="contacts", start_s=3.5, end_s=10.5),
    )
