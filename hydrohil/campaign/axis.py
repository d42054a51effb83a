"""The values of one swept parameter: a grid, a list, or a distribution that is drawn from once a repeat.

A draw is a function of (seed of the campaign, name of the axis, repeat) alone: it does not change when another axis is
added, and every point of the grids meets the same draws, so that two laws are tried on the same plants.
"""

import hashlib
import math
from statistics import NormalDist
from typing import Annotated, Any, Literal, NamedTuple

from annotated_types import Ge, Gt, MinLen
from pydantic import Field

from hydrohil.campaign.formula import parsed
from hydrohil.shared.draws import SPACING, uniforms

Scalar = bool | int | float | str


class Grid(NamedTuple):
    """`count` values from `from` to `to`, both included."""

    from_: Annotated[float, Field(alias="from")]
    to: float
    count_: Annotated[int, Field(alias="count"), Ge(2)]
    scale: Literal["linear", "log"] = "linear"


class Normal(NamedTuple):
    """Gaussian, cut off below `low` and above `high` where they are given."""

    mean: float
    deviation: Annotated[float, Gt(0)]
    low: float | None = None
    high: float | None = None


class Uniform(NamedTuple):
    """Equally likely from `low` to `high`."""

    low: float
    high: float


class LogNormal(NamedTuple):
    """Its logarithm is Gaussian about that of `median`; `sigma` 0.1 spreads by about a tenth."""

    median: Annotated[float, Gt(0)]
    sigma: Annotated[float, Gt(0)]
    low: float | None = None
    high: float | None = None


Drawn = Normal | Uniform | LogNormal


class Axis(NamedTuple):
    """Exactly one of the five; `sets` leads it to other fields, by formulas in `value`."""

    grid: Grid | None = None
    list: Annotated[tuple[Scalar, ...], MinLen(1)] | None = None
    normal: Normal | None = None
    uniform: Uniform | None = None
    lognormal: LogNormal | None = None
    sets: dict[str, str] = {}  # noqa: RUF012  path = formula; without it the axis' own name is the path


KINDS = ("grid", "list", "normal", "uniform", "lognormal")


def distribution(axis: Axis) -> Drawn | None:
    """The distribution of the axis; None for a grid or a list."""
    return axis.normal or axis.uniform or axis.lognormal


def values(axis: Axis) -> tuple[Any, ...]:
    """Every value of a grid or list; none of a distribution."""
    if axis.list is not None:
        return axis.list
    return () if axis.grid is None else tuple(_grid_value(axis.grid, number) for number in range(axis.grid.count_))


def _grid_value(grid: Grid, number: int) -> float:
    first, last, share = float(grid.from_), float(grid.to), number / (grid.count_ - 1)
    if number == grid.count_ - 1:
        return last
    return first * (last / first) ** share if grid.scale == "log" else first + (last - first) * share


def channel(name: str) -> int:
    """Channel of the random numbers of an axis, far from those of noise and jitter."""
    return int.from_bytes(hashlib.sha256(name.encode()).digest()[:8], "big")


def draw(axis: Axis, name: str, seed: int, repeat: int) -> float:
    """The value of repeat number `repeat`, by the inverse of the distribution function."""
    share = float(uniforms(seed, channel(name), repeat, 1)[0, 0]) - SPACING / 2.0
    if axis.uniform is not None:
        return axis.uniform.low + (axis.uniform.high - axis.uniform.low) * share
    if axis.lognormal is not None:
        median, sigma, low, high = axis.lognormal
        return math.exp(_gaussian(NormalDist(math.log(median), sigma), _log(low), _log(high), share))
    assert axis.normal is not None, name
    return _gaussian(NormalDist(axis.normal.mean, axis.normal.deviation), axis.normal.low, axis.normal.high, share)


def _log(bound: float | None) -> float | None:
    return None if bound is None or not bound > 0.0 else math.log(bound)


def _gaussian(normal: NormalDist, low: float | None, high: float | None, share: float) -> float:
    """Where the distribution function, cut off at `low` and `high`, reaches `share`."""
    below = 0.0 if low is None else normal.cdf(low)
    above = 1.0 if high is None else normal.cdf(high)
    reached = min(max(below + (above - below) * share, SPACING), 1.0 - SPACING)
    drawn = normal.inv_cdf(reached)
    return min(max(drawn, -math.inf if low is None else low), math.inf if high is None else high)


def axis_problems(axis: Axis) -> list[str]:
    """What is inconsistent in an axis, one line each."""
    given = [kind for kind in KINDS if getattr(axis, kind) is not None]
    if len(given) != 1:
        return [f"has {' and '.join(given) or 'nothing to sweep over'}: give exactly one of {', '.join(KINDS)}"]
    found = [] if axis.list is None else _list_problems(axis.list)
    found += [] if axis.grid is None else _grid_problems(axis.grid)
    drawn = distribution(axis)
    if drawn is not None and drawn.low is not None and drawn.high is not None and not drawn.low < drawn.high:
        found.append(f"{given[0]}.low is {drawn.low:g}: it must lie below high, {drawn.high:g}")
    if axis.lognormal is not None and axis.lognormal.high is not None and not axis.lognormal.high > 0.0:
        found.append(f"lognormal.high is {axis.lognormal.high:g}: expected more than 0")
    for path, formula in axis.sets.items():
        try:
            parsed(formula)
        except ValueError as reason:
            found.append(f"sets.{path}: {reason}")
    return found


def _list_problems(listed: tuple[Any, ...]) -> list[str]:
    kinds = {float if type(value) is int else type(value) for value in listed}
    found = [] if len(kinds) == 1 else ["list mixes numbers, text or truth values: one column holds one of them"]
    return found + ([] if len(set(listed)) == len(listed) else ["list names a value twice: use repeats for more trials of it"])


def _grid_problems(grid: Grid) -> list[str]:
    if grid.from_ == grid.to:
        return [f"grid goes from {grid.from_:g} to {grid.to:g}: they must differ"]
    if grid.scale == "log" and not (grid.from_ > 0.0 and grid.to > 0.0):
        return [f"grid goes from {grid.from_:g} to {grid.to:g}: on a log scale both must be above 0"]
    return []
