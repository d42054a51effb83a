"""The results of a fault test as data: for the page, the JUnit file, and a machine."""

import json
import math
from typing import Any, NamedTuple

from hydrohil.faulttest.tally import FAILED, HELD, NOT_TRIED, RowResult, WayResult, counts
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.exit_status import EXIT_CLAIM, EXIT_OK


class Report(NamedTuple):
    """Every row, and how it was tried."""

    results: tuple[RowResult, ...]
    trials: int
    seed: int
    lease_ms: float  # NaN: no cell was needed
    interrupted: bool
    source_version: str
    created_at: str  # date and time
    duration_s: float
    machine: str
    restarted: tuple[str, ...]  # trials that ended by themselves before their fault
    command: str = ""  # the command line that has run it

    @property
    def exit_status(self) -> int:
        """1 if a fault was not survived."""
        return EXIT_CLAIM if any(result.verdict == FAILED for result in self.results) else EXIT_OK

    @property
    def headline(self) -> str:
        """How many rows held, failed, were not tried."""
        found = counts(self.results)
        line = f"{found[HELD]} of {len(self.results)} faults survived"
        line += f", {found[FAILED]} NOT" if found[FAILED] else ""
        return line + (f", {found[NOT_TRIED]} not tried" if found[NOT_TRIED] else "")


def milliseconds(seconds: float) -> str:
    """A tenth of a millisecond; a dash where there is nothing."""
    return f"{1000.0 * seconds:.1f}" if math.isfinite(seconds) else "-"


def amount(value: float) -> str:
    """Three digits; a dash where there is nothing."""
    return f"{value:.3g}" if math.isfinite(value) else "-"


def first_failure(tried: WayResult) -> str:
    """What happened in the first trial that did not hold."""
    return next((trial.words for trial in tried.trials if not trial.held), tried.why)


def to_json(report: Report) -> str:
    """The report for a machine."""
    values = {
        name: value if not isinstance(value, float) else _number(value)
        for name, value in report._asdict().items()
        if name != "results"
    }
    values |= {"exit_status": report.exit_status, "rows": [_row(result) for result in report.results]}
    return json.dumps(values, indent=2, allow_nan=False) + "\n"


def _row(result: RowResult) -> dict[str, Any]:
    row = result.row
    return {
        "number": row.number,
        "fault": row.fault,
        "must": row.must,
        "bound": row.bound,
        "verdict": result.verdict,
        "ways": [_way(tried) for tried in result.tried],
    }


def _way(tried: WayResult) -> dict[str, Any]:
    return {
        "way": tried.way.letter,
        "words": tried.way.words,
        "verdict": tried.verdict,
        "why": tried.why or None,
        "trials": [_trial(trial) for trial in tried.trials],
    }


def _trial(trial: Trial) -> dict[str, Any]:
    plain = {name: _number(value) if isinstance(value, float) else value for name, value in trial._asdict().items()}
    return plain | {"hops": dict(trial.hops)}


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
