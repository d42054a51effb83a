"""The trials of one way added up: in how many it held, worst and median reaction, largest motion."""

import math
from collections.abc import Iterable, Sequence
from statistics import median
from typing import NamedTuple

from hydrohil.faulttest.trial import Row, Trial, Way

HELD, FAILED, NOT_TRIED = "held", "FAILED", "not tried"


class WayResult(NamedTuple):
    """The trials of one way of one row; without trials `why` says why it was not tried."""

    way: Way
    trials: tuple[Trial, ...]
    why: str = ""  # why it was not tried, or not to the end

    @property
    def verdict(self) -> str:
        """Held in every trial, failed in one, or not tried."""
        if not self.trials:
            return NOT_TRIED
        return HELD if all(trial.held for trial in self.trials) else FAILED

    @property
    def held(self) -> int:
        """In how many trials."""
        return sum(trial.held for trial in self.trials)

    def worst(self, name: str) -> float:
        """Largest value of a field over the trials; NaN where none has one."""
        return max(self._known(name), default=math.nan)

    def middle(self, name: str) -> float:
        """Median of a field over the trials; NaN where none has one."""
        known = self._known(name)
        return median(known) if known else math.nan

    def _known(self, name: str) -> list[float]:
        return [value for trial in self.trials if math.isfinite(value := getattr(trial, name))]

    @property
    def hops(self) -> tuple[tuple[str, float, float], ...]:
        """Name, median and worst ms of each hop at the trip."""
        by_name: dict[str, list[float]] = {}
        for trial in self.trials:
            for name, ms in trial.hops:
                by_name.setdefault(name, []).append(ms)
        return tuple((name, median(values), max(values)) for name, values in by_name.items())


class RowResult(NamedTuple):
    """One row, in every way in which it was or was not tried."""

    row: Row
    tried: tuple[WayResult, ...]

    @property
    def verdict(self) -> str:
        """Failed if one way failed, held if one was tried and none failed, otherwise not tried."""
        return of_all(tried.verdict for tried in self.tried)


def of_all(verdicts: Iterable[str]) -> str:
    """The verdict of several: failing outweighs holding, holding outweighs not trying."""
    found = set(verdicts)
    return FAILED if FAILED in found else HELD if HELD in found else NOT_TRIED


def counts(results: Sequence[RowResult]) -> dict[str, int]:
    """How many rows held, failed, were not tried."""
    return {verdict: sum(result.verdict == verdict for result in results) for verdict in (HELD, FAILED, NOT_TRIED)}
