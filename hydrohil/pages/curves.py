"""Curves thinned for a page that holds a hundred of them. Points that no pixel shows are left out; extremes are kept."""

from itertools import pairwise

import numpy as np

from hydrohil.claims.study import Curve
from hydrohil.claims.trace import Integers, Reals

MOST_POINTS = 1500


def thinned(curve: Curve, most: int = MOST_POINTS) -> Curve:
    """`curve` with about `most` points: both ends, and the extremes of each stretch in their order."""
    if len(curve.x) <= most:
        return curve
    kept = kept_rows(curve.x, curve.y, most)
    return curve._replace(x=curve.x[kept], y=curve.y[kept])


def kept_rows(x: Reals, y: Reals, most: int) -> Integers:
    """(m,) rows of the smallest and largest y of each stretch, and of x where the curve turns back in x."""
    forwards = bool(np.all(np.diff(x) >= 0.0))
    signals = (y,) if forwards else (y, x)
    bounds = np.linspace(0, len(x), max(1, most // (2 * len(signals))) + 1).astype(int)
    kept = {0, len(x) - 1}
    for start, end in pairwise(bounds.tolist()):
        for signal in signals:
            stretch = signal[start:end]
            kept |= {int(start + np.argmin(stretch)), int(start + np.argmax(stretch))}
    return np.array(sorted(kept), dtype=np.int64)
