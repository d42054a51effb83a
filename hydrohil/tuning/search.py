"""Search for the largest gain that passes: up in steps from a safe one, then by bisection of the last step."""

import math
from collections.abc import Callable
from typing import NamedTuple


class Tried(NamedTuple):
    """One value that was tried, whether it passed, and the numbers that decided."""

    value: float
    passed: bool
    numbers: tuple[float, ...]


class Found(NamedTuple):
    """All values tried, ascending, and whether a larger one than the largest that passed failed."""

    tried: tuple[Tried, ...]
    bounded: bool

    @property
    def passed(self) -> tuple[Tried, ...]:
        """Values below the smallest that failed."""
        first = next((number for number, one in enumerate(self.tried) if not one.passed), len(self.tried))
        return self.tried[:first]

    @property
    def largest(self) -> Tried | None:
        """The largest value that passed with all below it."""
        return self.passed[-1] if self.passed else None


def largest(
    judge: Callable[[float], Tried], start: float, factor: float, ceiling: float, floor: float, precision: float
) -> Found:
    """Multiply by `factor` while the value passes (divide while it does not), then halve the last step geometrically.

    Nothing above `ceiling` or below `floor` is tried; the bracket closes to the ratio 1 + `precision`.
    """
    tried = [judge(start)]
    if tried[0].passed:
        while tried[-1].passed and tried[-1].value * factor <= ceiling:
            tried.append(judge(tried[-1].value * factor))
        bad = None if tried[-1].passed else tried[-1].value
        good: float | None = tried[-1].value if bad is None else tried[-2].value
    else:
        while not tried[-1].passed and tried[-1].value / factor >= floor:
            tried.append(judge(tried[-1].value / factor))
        good = tried[-1].value if tried[-1].passed else None
        bad = tried[-2].value if good is not None else tried[-1].value
    while good is not None and bad is not None and bad / good > 1.0 + precision:
        tried.append(judge(math.sqrt(good * bad)))
        good, bad = (tried[-1].value, bad) if tried[-1].passed else (good, tried[-1].value)
    return Found(tuple(sorted(tried, key=lambda one: one.value)), bad is not None)
