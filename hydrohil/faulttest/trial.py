"""What one trial of one fault showed, and the ways in which a fault can be tried."""

import math
from collections.abc import Callable
from random import Random
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from hydrohil.faulttest.rig import Rig


class Trial(NamedTuple):
    """One fault, once."""

    held: bool
    words: str  # what happened, to explain a failure
    reaction_s: float = math.nan  # from the fault to zero current, or another time that the row bounds; NaN = nothing to time
    bound_s: float = math.nan  # what it must not exceed; NaN = the row bounds no time
    stalled_s: float = 0.0  # of the reaction: the host stopped the plant itself, whose grid and machine stood still
    moved_mm: float = math.nan  # largest distance of the tip from where it was at the fault
    force_n: float = math.nan  # largest change of the contact force since the fault
    hops: tuple[tuple[str, float], ...] = ()  # name and ms of each hop at the trip

    @property
    def in_time(self) -> bool:
        """Whether the reaction is within its bound, if it has one; a NaN reaction under a bound is not."""
        return math.isnan(self.bound_s) or self.reaction_s - self.stalled_s <= self.bound_s


class ByTests(NamedTuple):
    """P: tests that prove the row; named by their pytest node ids."""

    words: str
    tests: tuple[str, ...]
    letter: str = "P"  # or "W": those tests start real processes on the wall clock


class Simulated(NamedTuple):
    """L: a trial on the local clock, exact to the tick."""

    words: str
    trial: Callable[[int], Trial]  # of a seed
    letter: str = "L"
    max_trials: int = 5  # trials; more seeds show nothing new


class Live(NamedTuple):
    """W: real processes, the wall clock, a random phase. L: the same processes in lockstep, exact to the tick."""

    words: str
    trial: Callable[["Rig", Random, int], Trial]  # of the rig, its random numbers, and which trial this is
    letter: str = "W"
    max_trials: int = 1000
    in_shared_cell: bool = True  # in the cell that most trials share; False: it brings up its own


class NotTried(NamedTuple):
    """Nothing is tried, and this is why; never counted as survived."""

    words: str
    letter: str = "-"


Way = ByTests | Simulated | Live | NotTried


class Row(NamedTuple):
    """One fault of the matrix."""

    number: str
    fault: str
    must: str  # what must happen
    bound: str  # in leases and sample periods T
    ways: tuple[Way, ...]
