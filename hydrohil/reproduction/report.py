"""All that was reproduced, as data: the page, the JUnit file and the JSON file are written from it."""

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
from hydrohil.reproduction.tally import Count, Result, Tally, counts, exit_status, failures, total
from hydrohil.reproduction.tally import result as result_of


class Report(NamedTuple):
    """Every figure, and on which clock, with how many seeds and by which sources it was reproduced."""

    results: tuple[Result, ...]
    clock: str
    seeds: int
    source_version: str
    created_at: str  # date and time
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
    ordered = sorted(done, key=lambda one: one.job.seed)
    drawn = {name: drawings for one in ordered for name, drawings in one.drawn.items()}
    return tuple(
        result_of(
            figure,
            [(one.job.seed, found) for one in ordered for found in one.found if found.figure == figure.name],
            drawn.get(figure.name, ()),
        )
        for figure in figures
    )


def times_real_time(done: list[Done]) -> float:
    """Simulated seconds per second of one core, median over the jobs; NaN where none was played on the local clock.

    Jobs that run at the same time slow each other, and the first one includes the load of the compiled loop.
    """
    speeds = [one.job.simulated_s / one.played_s for one in done if one.job.group.trials and one.played_s > 0.0]
    return median(speeds) if speeds else math.nan


def machine() -> str:
    """This computer: processor, number of cores, system and Python."""
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
    """The report as JSON text."""
    whole = report.total
    document = {
        "source_version": report.source_version,
        "clock": report.clock,
        "seeds": report.seeds,
        "created_at": report.created_at,
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
        "figures": [_figure(result) for result in report.results],
    }
    return json.dumps(document, indent=2, allow_nan=False) + "\n"


def _figure(result: Result) -> dict[str, Any]:
    subject = result.figure.subject
    return {
        "name": result.figure.name,
        "names": list(result.figure.names),
        "title": subject.title,
        "source": subject.source,
        "tripped": list(result.tripped),
        "gaps": list(result.gaps),
        "claims": [_claim(one) for one in result.tallies],
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
