"""What chapter 7 of the thesis says of prolonged contact, as bands.

A limit cycle is the link going there and back, by two encoder counts or more, more than once. "Eventual" is read as: in
the second half of the trial, or at any time where cycles are "sporadic"; "approximately 3 mm" as 2.5 to 3.5 mm, 3 mm being
0.17 deg at the lever of 1 m; "sporadic" as a pause in which a whole cycle of two turns would have had its place; "appeared
to increase" as any increase.
"""

from hydrohil.claims.bands import Measure, at_least, at_most, between
from hydrohil.claims.claims import Claim
from hydrohil.claims.pairs import PairClaim
from hydrohil.thesis.claims5 import BREAK_AWAY_MA

HALF_S, END_S = 120.0, 240.0
RESPONSE_S = 20.0  # the response to the step is over, also where it is highly underdamped

_EVENTUAL = (
    'thesis 7.2: "All trials where the target stiffness was less than the effective environmental stiffness resulted in '
    'eventual limit cycles."'
)
_SOURCE = (
    'thesis 7.2: "The source of these limit cycles can be most clearly seen in the position plots, where the set-point moves '
    'in response to the change in force resulting from actually reaching the set-point."'
)
_AMPLITUDE = (
    'thesis 7.2: "The amplitude of oscillation was approximately 3mm (see Figure 7-2, for example), corresponding to 0.17 deg '
    'of up/down motion, the previously established minimum tracking error."'
)
_ONSET = (
    'thesis 7.2: "The onset of these cycles was slowest for the lowest value of stiffness because of the low natural '
    'frequency of that system."'
)
_FREQUENCY = (
    'thesis 7.2: "The frequency of cycling appeared to increase with the higher natural frequencies resulting from increased '
    'target stiffness."'
)
_SPORADIC = 'thesis 7.2: "Note, however, that the oscillations became sporadic in the k=5000N/m trial."'
_NONE = (
    'thesis 7.2: "no limit cycles were observed for the greatest value of stiffness (see Figure 7-4) ... This stability is '
    'observed in spite of the highly underdamped response of the system."'
)
_HEAVY = (
    'thesis 7.2: "The increased mass slows the system response, but does not prevent the eventual occurrence of limit cycles."'
)
_LIGHT = 'thesis 7.2: "Conversely, a trial using a low mass and high stiffness fails to indicate any likelihood of instability."'


def _cycles(source: str, start_s: float = HALF_S) -> Claim:
    """More than one cycle from `start_s` on."""
    return at_least("The link cycles", Measure("cycles", "q2", "counts", start_s, END_S), 2.0, source)


def _regular() -> tuple[Claim, ...]:
    """What the text says of the cycles at 50 and 500 N/m."""
    along_z = Measure("cycle_amplitude", "z", "mm", HALF_S, END_S)
    of_link = Measure("cycle_amplitude", "q2", "deg", HALF_S, END_S)
    return (
        _cycles(_EVENTUAL),
        between("The cycles are of about 3 mm", along_z, 2.5, 3.5, _AMPLITUDE),
        between("The cycles are of about 0.17 deg of up/down motion", of_link, 0.143, 0.2, _AMPLITUDE),
        at_least(
            "The set-point mostly moves away from where the link stands",
            Measure("yielding_share", "q2", "1", HALF_S, END_S),
            0.5,
            _SOURCE,
        ),
    )


def _stable(source: str) -> tuple[Claim, ...]:
    """No limit cycle: once the response is over, the link rests."""
    rests = at_most("There is no limit cycle", Measure("cycles", "q2", "counts", RESPONSE_S, END_S), 0.0, source)
    return (rests, rests._replace(statement="The link rests within two counts", metric="peak_to_peak_counts", high=2.0))


CLAIMS: dict[str, tuple[Claim, ...]] = {
    "fig-7-1": _regular(),
    "fig-7-2": _regular(),
    "fig-7-3": (
        _cycles(_EVENTUAL, 0.0),
        at_least("The cycles become sporadic", Measure("pause_ratio", "q2", "1", 0.0, END_S), 2.0, _SPORADIC),
    ),
    "fig-7-4": (
        *_stable(_NONE),
        _cycles(_NONE, 0.0)._replace(statement="The response itself goes there and back", low=1.0, end_s=RESPONSE_S),
    ),
    "fig-7-5": (_cycles(_HEAVY),),
    "fig-7-6": (
        *_stable(_LIGHT),
        at_most(
            "The control stays below the break-away of 88 mA",
            Measure("control_peak", "q2", "mA", RESPONSE_S, END_S),
            BREAK_AWAY_MA,
            _LIGHT,
        ),
    ),
}

_OVER = PairClaim(
    "",
    of="",
    against="",
    measure="metric_ratio",
    channel="q2",
    comparison="above",
    start_s=0.0,
    end_s=END_S,
    unit="1",
    metric="cycle_onset_s",
    low=1.0,
    source=_ONSET,
)
_OFTENER = _OVER._replace(metric="cycle_period_s", comparison="below", low=0.0, high=1.0, source=_FREQUENCY)
PAIRS = (
    _OVER._replace(statement="Cycles set in later at 50 than at 500 N/m", of="fig-7-1", against="fig-7-2"),
    _OVER._replace(statement="Cycles set in later at 50 than at 5000 N/m", of="fig-7-1", against="fig-7-3"),
    _OFTENER._replace(statement="Cycles are faster at 500 than at 50 N/m", of="fig-7-2", against="fig-7-1"),
    _OFTENER._replace(statement="Cycles are faster at 5000 than at 500 N/m", of="fig-7-3", against="fig-7-2"),
    _OVER._replace(statement="A hundred times the mass delays them", of="fig-7-5", against="fig-7-1", source=_HEAVY),
)
