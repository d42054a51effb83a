"""Claims in one line: what is measured, and the band that a source gives it. A value on the band holds."""

from typing import NamedTuple

from hydrohil.claims.claims import Claim, Comparison, Unit
from hydrohil.claims.metrics import MetricName
from hydrohil.claims.signals import ChannelName


class Measure(NamedTuple):
    """A metric of a channel in the window from `start_s` to `end_s`, stated in `unit`."""

    metric: MetricName
    channel: ChannelName
    unit: Unit
    start_s: float
    end_s: float


def at_most(statement: str, measure: Measure, high: float, source: str) -> Claim:
    """The claim that the measure is `high` or less."""
    return _claim(statement, measure, "below", source)._replace(high=high)


def at_least(statement: str, measure: Measure, low: float, source: str) -> Claim:
    """The claim that the measure is `low` or more."""
    return _claim(statement, measure, "above", source)._replace(low=low)


def between(statement: str, measure: Measure, low: float, high: float, source: str) -> Claim:
    """The claim that the measure is `low`, `high` or a value between them."""
    return _claim(statement, measure, "within", source)._replace(low=low, high=high)


def _claim(statement: str, measure: Measure, comparison: Comparison, source: str) -> Claim:
    return Claim(statement, comparison=comparison, source=source, **measure._asdict())
