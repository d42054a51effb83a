"""Verdicts over seeds: how often a claim holds, its mean and spread, and counts per chapter."""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from hydrohil.claims.claims import Stated, Verdict
from hydrohil.pages.drawing import Drawing
from hydrohil.reproduction.explanations import explanation
from hydrohil.reproduction.plan import CHAPTERS, Figure
from hydrohil.reproduction.play import Found
from hydrohil.shared.exit_status import EXIT_CLAIM, EXIT_OK, EXIT_TRANSPORT, EXIT_TRIPPED

ENOUGH_PERCENT = 95  # of the seeds


class Tally(NamedTuple):
    """One claim over its seeds."""

    claim: Stated
    measured: tuple[float, ...]  # one a seed, in the claim's unit; NaN where the trial does not determine it
    held: int

    @property
    def seeds(self) -> int:
        """Number of seeds in which it was judged."""
        return len(self.measured)

    @property
    def holds(self) -> bool:
        """Whether it holds in 95 % of the seeds; of fewer than twenty seeds these are all."""
        return 100 * self.held >= ENOUGH_PERCENT * self.seeds

    @property
    def determined(self) -> tuple[float, ...]:
        """The measured values that are numbers: a trial may not determine a claim."""
        return tuple(value for value in self.measured if math.isfinite(value))

    @property
    def mean(self) -> float:
        """Mean over the seeds that determine it."""
        return float(np.mean(self.determined)) if self.determined else math.nan

    @property
    def spread(self) -> float:
        """Standard deviation over the seeds that determine it."""
        return float(np.std(self.determined)) if self.determined else math.nan


class Result(NamedTuple):
    """One figure over its seeds."""

    figure: Figure
    tallies: tuple[Tally, ...]
    drawings: tuple[Drawing, ...]  # of the first seed
    tripped: tuple[str, ...]
    gaps: tuple[str, ...]


class Count(NamedTuple):
    """How many claims hold."""

    title: str
    figures: int
    claims: int
    hold: int

    @property
    def fail(self) -> int:
        """Number of claims that do not hold."""
        return self.claims - self.hold


class Failure(NamedTuple):
    """A claim that does not hold, and why; "" is unexplained."""

    figure: Figure
    tally: Tally
    why: str


def tally(verdicts: Sequence[Verdict]) -> Tally:
    """One claim's verdicts, one a seed."""
    return Tally(verdicts[0].claim, tuple(float(v.measured) for v in verdicts), sum(bool(v.holds) for v in verdicts))


def result(figure: Figure, found: Sequence[tuple[int, Found]], drawings: tuple[Drawing, ...]) -> Result:
    """`found` holds what each seed shows; a figure computed from no trial is the same in all and counts once."""
    by_statement: dict[str, list[Verdict]] = {}
    for _, shown in found:
        for verdict in shown.verdicts:
            by_statement.setdefault(verdict.claim.statement, []).append(verdict)
    tripped = tuple(f"seed {seed}: {shown.tripped}" for seed, shown in found if shown.tripped)
    gaps = tuple(f"seed {seed}: {shown.gap}" for seed, shown in found if shown.gap)
    return Result(
        figure=figure,
        tallies=tuple(tally(verdicts) for verdicts in by_statement.values()),
        drawings=drawings,
        tripped=tripped,
        gaps=gaps,
    )


def counts(results: Iterable[Result]) -> tuple[Count, ...]:
    """One row a chapter, in their order."""
    chapters: dict[str, list[Result]] = {}
    for result in results:
        chapters.setdefault(result.figure.chapter, []).append(result)
    return tuple(_count(CHAPTERS[chapter], of) for chapter, of in chapters.items())


def total(results: Sequence[Result]) -> Count:
    """Claims of all chapters."""
    return _count("all", results)


def _count(title: str, results: Sequence[Result]) -> Count:
    tallies = [one for result in results for one in result.tallies]
    return Count(title, len(results), len(tallies), sum(one.holds for one in tallies))


def failures(results: Iterable[Result]) -> tuple[Failure, ...]:
    """Every claim that does not hold, with the best explanation."""
    return tuple(
        Failure(result.figure, one, explanation(result.figure.name, one.claim.statement))
        for result in results
        for one in result.tallies
        if not one.holds
    )


def exit_status(results: Sequence[Result]) -> int:
    """3 a trial tripped, 5 a trial has gaps, 1 a claim does not hold, 0 all hold."""
    if any(result.tripped for result in results):
        return EXIT_TRIPPED
    if any(result.gaps for result in results):
        return EXIT_TRANSPORT
    return EXIT_CLAIM if failures(results) else EXIT_OK
