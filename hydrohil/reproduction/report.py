"""All that was reproduced at once, as data: for the page, the JUnit file, and a machine."""

import json
import math
import os
import platform
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

from hydrohil.claims.claims import band
from hydrohil.reproduction.jobs import Done
from hydrohil.reproduction.plan import Figure
from hydrohil.reproduction.tally import Count, Result, Tally, counts, exit_status, failures, result, total


class Report(NamedTuple):
    """Every figure, and how it was made."""

    results: tuple[Result, ...]
    clock: str
    seeds: int
    source_version: str
    made: str  # date and time
    duration_s: float
    machine: str
    command: str
    times_real_time: float  # of one core; NaN where no trial was played on the local clock

    @property
    def exit_status(self) -> int:
        """3 tripped, 5 gaps, 1 a claim fails, 0 all hold."""
        return exit_status(self.results)

    @property
    def counts(self) -> tuple[Count, ...]:
        """Claims per chapter."""
        return counts(self.results)

    @property
    def total(self) -> Count:
        """Claims of all chapters."""
        return total(self.results)


def gathered(figures: tuple[Figure, ...], done: list[Done]) -> tuple[Result, ...]:
    """What all jobs found, figure by figure, seeds in their order."""
    ordered = sorted(done, key=lambda made: made.job.seed)
    drawn = {name: drawings for made in ordered for name, drawings in made.drawn.items()}
    return tuple(
        result(
            figure,
            [(made.job.seed, seen) for made in ordered for seen in made.found if seen.figure == figure.name],
            drawn.get(figure.name, ()),
        )
        for figure in figures
    )


def times_real_time(done: list[Done]) -> float:
    """Simulated seconds per second of one core, median over the jobs: while several run, and a cold one loads."""
    speeds = [made.job.simulated_s / made.played_s for made in done if made.job.group.trials and made.played_s > 0.0]
    return median(speeds) if speeds else math.nan


def machine() -> str:
    """Which computer this is: its processor, how many of them, its system and Python."""
    names = [line.partition(":")[2].strip() for line in _cpuinfo() if line.startswith("model name")]
    processor = names[0] if names else platform.processor() or platform.machine()
    cores = len(os.sched_getaffinity(0))
    return f"{processor}, {cores} cores, {platform.system()} {platform.release()}, Python {platform.python_version()}"


def _cpuinfo() -> list[str]:
    try:
        return Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return []


def to_json(report: Report) -> str:
    """The report for a machine."""
    whole = report.total
    told = {
        "source_version": report.source_version,
        "clock": report.clock,
        "seeds": report.seeds,
        "made": report.made,
        "duration_s": report.duration_s,
        "machine": report.machine,
        "times_real_time": _number(report.times_real_time),
        "command": report.command,
        "exit_status": report.exit_status,
        "claims": whole.claims,
        "hold": whole.hold,
        "chapters": [{"title": c.title, "figures": c.figures, "claims": c.claims, "hold": c.hold} for c in report.counts],
        "fail": [
            {"figure": f.figure.name, "statement": f.tally.claim.statement, "why": f.why or None}
            for f in failures(report.results)
        ],
        "figures": [_figure(made) for made in report.results],
    }
    return json.dumps(told, indent=2, allow_nan=False) + "\n"


def _figure(made: Result) -> dict[str, Any]:
    subject = made.figure.subject
    return {
        "name": made.figure.name,
        "names": list(made.figure.names),
        "title": subject.title,
        "source": subject.source,
        "tripped": list(made.tripped),
        "gaps": list(made.gaps),
        "claims": [_claim(one) for one in made.tallies],
    }


def _claim(one: Tally) -> dict[str, Any]:
    return {
        "statement": one.claim.statement,
        "source": one.claim.source,
        "stated": band(one.claim),
        "unit": one.claim.unit,
        "measured": [_number(value) for value in one.measured],
        "mean": _number(one.mean),
        "spread": _number(one.spread),
        "held": one.held,
        "seeds": one.seeds,
        "holds": one.holds,
    }


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
