"""Claims about two trials at once: one law against another, a controller against its equivalent."""

import math
from collections.abc import Callable
from typing import Annotated, Literal, NamedTuple

import numpy as np
from annotated_types import Ge

from hydrohil.claims.claims import UNITS, Comparison, Unit, Verdict, reaches, verdict
from hydrohil.claims.metrics import METRICS, MetricName
from hydrohil.claims.signals import JOINTS, ChannelName, control, measured, rms
from hydrohil.claims.trace import Reals, Trace, window

PairMeasure = Literal["metric_ratio", "correlation", "rms_difference", "control_correlation"]


class PairClaim(NamedTuple):
    """One statement of a source about the trial `of` set against the trial `against`, both with the same seed.

    `metric_ratio` is the metric of `of` over that of `against`; the other measures set signals of the channel side by side,
    sample by sample: measured values, or (`control_correlation`) the current that the law commanded.
    """

    statement: str
    of: str  # name of an experiment
    against: str
    measure: PairMeasure
    channel: ChannelName
    comparison: Comparison
    start_s: Annotated[float, Ge(0)]
    end_s: Annotated[float, Ge(0)]
    unit: Unit
    metric: MetricName | None = None  # of a metric_ratio
    low: float = 0.0
    high: float = 0.0
    source: str = ""


def judge_pair(claim: PairClaim, of: Trace, against: Trace) -> Verdict:
    """Measure `claim` on its two traces; a window that either does not determine, or ended within, is NaN and fails."""
    one, other = window(of, claim.start_s, claim.end_s), window(against, claim.start_s, claim.end_s)
    if not (reaches(one, claim.end_s) and reaches(other, claim.end_s)):
        return verdict(claim, math.nan)
    if claim.metric is not None:
        metric = METRICS[claim.metric].of
        return verdict(claim, _ratio(metric(one, claim.channel), metric(other, claim.channel)) / UNITS[claim.unit][1])
    values = _MEASURES[claim.measure]
    return verdict(claim, values(*_side_by_side(claim, one, other)) / UNITS[claim.unit][1])


def _side_by_side(claim: PairClaim, one: Trace, other: Trace) -> tuple[Reals, Reals]:
    """Both signals (n,) at the samples of the first; jitter may differ, so the second is interpolated."""
    signal = control if claim.measure == "control_correlation" else measured
    return signal(one, claim.channel), np.interp(one.t_s, other.t_s, signal(other, claim.channel))


def _ratio(above: float, below: float) -> float:
    return above / below if below > 0.0 else math.nan


def _correlation(one: Reals, other: Reals) -> float:
    if np.ptp(one) == 0.0 or np.ptp(other) == 0.0:
        return math.nan
    return float(np.corrcoef(one, other)[0, 1])


_MEASURES: dict[PairMeasure, Callable[[Reals, Reals], float]] = {
    "correlation": _correlation,
    "control_correlation": _correlation,
    "rms_difference": lambda one, other: rms(one - other),
}


def pair_problems(claim: PairClaim) -> list[str]:
    """What is inconsistent in a pair claim."""
    found = []
    if (claim.metric is not None) != (claim.measure == "metric_ratio"):
        found.append("metric belongs to metric_ratio, and to nothing else")
    if claim.measure == "control_correlation" and claim.channel not in JOINTS:
        found.append("control_correlation is defined on q1, q2, q3")
    if not claim.start_s < claim.end_s:
        found.append("end_s must lie after start_s")
    return found
