"""Claims: what a source states, as a number that a trace must show within a band; and the verdict of a trace on each."""

import math
from typing import Annotated, Literal, NamedTuple, Protocol

from annotated_types import Ge, MinLen

from hydrohil.claims.metrics import METRICS, Dimension, MetricName
from hydrohil.claims.signals import JOINTS, ChannelName
from hydrohil.claims.trace import Trace, window
from hydrohil.shared.units import A_PER_MA, RAD_PER_DEG

ROUNDING = 1e-9  # two encoder counts, measured as a difference of angles, are 2 +- a few 1e-15 of a full turn
LATE_S = 0.1  # jitter adds up: the last sample lies this far before the trial's nominal end at most
Comparison = Literal["below", "above", "within"]
Unit = Literal["rad", "deg", "m", "mm", "cm", "N", "A", "mA", "s", "1/s", "1", "%", "counts", "kN/m", "deg/s"]

UNITS: dict[Unit, tuple[Dimension, float]] = {  # what it measures, SI per unit
    "rad": ("angle", 1.0),
    "deg": ("angle", RAD_PER_DEG),
    "m": ("length", 1.0),
    "mm": ("length", 1e-3),
    "cm": ("length", 1e-2),
    "N": ("force", 1.0),
    "A": ("current", 1.0),
    "mA": ("current", A_PER_MA),
    "s": ("time", 1.0),
    "1/s": ("rate", 1.0),
    "1": ("number", 1.0),
    "%": ("number", 0.01),
    "counts": ("number", 1.0),
    "kN/m": ("stiffness", 1e3),
    "deg/s": ("speed", RAD_PER_DEG),
}


class Stated(Protocol):
    """What every statement has: its text, a band in a unit, a source."""

    @property
    def statement(self) -> str: ...  # noqa: D102
    @property
    def comparison(self) -> Comparison: ...  # noqa: D102
    @property
    def unit(self) -> Unit: ...  # noqa: D102
    @property
    def low(self) -> float: ...  # noqa: D102
    @property
    def high(self) -> float: ...  # noqa: D102
    @property
    def source(self) -> str: ...  # noqa: D102


class Claim(NamedTuple):
    """One statement of a source, as a metric of a channel in a window against a band in `unit`; on the band holds."""

    statement: Annotated[str, MinLen(1)]  # a sentence
    metric: MetricName
    channel: ChannelName
    comparison: Comparison
    start_s: Annotated[float, Ge(0)]
    end_s: Annotated[float, Ge(0)]
    unit: Unit
    low: float = 0.0  # of "above" and "within"
    high: float = 0.0  # of "below" and "within"
    source: str = ""  # section or figure, and the sentence


class Verdict(NamedTuple):
    """A claim, what was measured in the claim's unit, and whether it holds."""

    claim: Stated
    measured: float
    holds: bool


def verdict(stated: Stated, measured: float) -> Verdict:
    """The verdict on a number in the statement's unit."""
    return Verdict(stated, measured, within_band(stated, measured))


def judge(claim: Claim, trace: Trace) -> Verdict:
    """Measure `claim` on `trace`. A NaN does not hold, nor does a window that the trial did not reach the end of."""
    inside = window(trace, claim.start_s, claim.end_s)
    if not reaches(inside, claim.end_s):
        return Verdict(claim, math.nan, False)
    measured = METRICS[claim.metric].of(inside, claim.channel) / UNITS[claim.unit][1]
    return verdict(claim, measured)


def reaches(inside: Trace, end_s: float) -> bool:
    """Whether a window's rows go on to its end: a trial that ended early says nothing of what would have come."""
    return len(inside.t_s) >= 2 and float(inside.t_s[-1]) >= end_s - LATE_S


def within_band(claim: Stated, measured: float) -> bool:
    """Whether `measured`, in the claim's unit, is what the claim states; on the limit it is, NaN is not."""
    above = measured >= claim.low - ROUNDING * abs(claim.low)
    below = measured <= claim.high + ROUNDING * abs(claim.high)
    return {"above": above, "below": below, "within": above and below}[claim.comparison]


def band(claim: Stated) -> str:
    """The claim's band as text, e.g. `within 3.2..3.4 s`, `exactly 1 counts`."""
    if claim.comparison == "within" and claim.low == claim.high:
        return f"exactly {quantity(claim.low, claim.unit)}"
    if claim.comparison == "within":
        return f"within {claim.low:.4g}..{quantity(claim.high, claim.unit)}"
    return f"{claim.comparison} {quantity(claim.low if claim.comparison == 'above' else claim.high, claim.unit)}"


def quantity(value: float, unit: Unit, digits: int = 4) -> str:
    """A number with its unit, unless it is a plain number."""
    return f"{value:.{digits}g}" + ("" if unit == "1" else f" {unit}")


def dimension(metric: MetricName, channel: ChannelName) -> Dimension:
    """What a metric of a channel measures in."""
    known = METRICS[metric].dimension
    if known != "channel":
        return known
    if channel == "force":
        return "force"
    return "angle" if channel in JOINTS[:2] else "length"


def problems(claim: Claim, duration_s: float) -> list[tuple[str, str]]:
    """What is inconsistent in a claim, as (field, what was found and expected)."""
    found = []
    metric = METRICS[claim.metric]
    if claim.channel not in metric.channels:
        found.append(("channel", f"is {claim.channel}: {claim.metric} is defined on {', '.join(metric.channels)}"))
    measures, expected = UNITS[claim.unit][0], dimension(claim.metric, claim.channel)
    if measures != expected:
        fitting = ", ".join(unit for unit, (of, _) in UNITS.items() if of == expected)
        found.append(("unit", f"is {claim.unit}: {claim.metric} of {claim.channel} is stated in one of {fitting}"))
    if claim.comparison == "within" and claim.low > claim.high:
        found.append(("low", f"is {claim.low:g} {claim.unit}: it must not lie above high, {claim.high:g} {claim.unit}"))
    if not claim.start_s < claim.end_s <= duration_s:
        found.append(("end_s", f"is {claim.end_s:g} s: it must lie after start_s, {claim.start_s:g} s, and not after the end"))
    return found
