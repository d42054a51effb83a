"""Percentiles of a measurement."""

import math
from collections.abc import Sequence
from typing import NamedTuple


class Spread(NamedTuple):
    """Percentiles by nearest rank, in the unit of what was measured; NaN without values."""

    p50: float = math.nan
    p99: float = math.nan
    p999: float = math.nan
    max: float = math.nan


def percentile(values: Sequence[float], share: float) -> float:
    """Nearest rank; NaN without values."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else math.nan


def spread(values: Sequence[float]) -> Spread:
    """p50, p99, p99.9 and max."""
    ordered = sorted(values)  # once
    p50, p99, p999 = (percentile(ordered, share) for share in (0.5, 0.99, 0.999))
    return Spread(p50, p99, p999, max(ordered, default=math.nan))
