"""The record of this host: the figures of every trial, and the summary that arming, recordings and reports carry."""

import json
import math
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from hydrohil.qualification.grading import (
    Figures,
    Verdict,
    deciding_period_ns,
    is_evidence,
    late_share,
    lease_ns,
    qualified_period_ns,
)
from hydrohil.shared.compiled.kernel import source_version
from hydrohil.shared.host.qualified import Host, Qualified

_NS_PER_MS = 1e6


class RateTrial(NamedTuple):
    """One rate, measured and judged."""

    figures: Figures
    verdict: Verdict
    measured_at: str  # date and time


def plain(trial: RateTrial) -> dict[str, Any]:
    """One trial as JSON has it: null is a number that was not measured."""
    spreads = {name: value for name, value in trial.figures._asdict().items() if hasattr(value, "_asdict")}
    figures = trial.figures._asdict() | {name: value._asdict() for name, value in spreads.items()}
    derived = {"late_share": late_share(trial.figures), "lease_ns": lease_ns(trial.figures)}
    values: dict[str, Any] = finite(trial.verdict._asdict() | {"measured_at": trial.measured_at} | derived | figures)
    return values


def finite(values: Any) -> Any:
    """`values` with None in place of every number that is none."""
    if isinstance(values, dict):
        return {name: finite(value) for name, value in values.items()}
    if isinstance(values, list | tuple):
        return [finite(value) for value in values]
    return None if isinstance(values, float) and not math.isfinite(values) else values


def keep(path: Path, host: Host, tried: Iterable[RateTrial]) -> Qualified | None:
    """Write what is evidence, in the place of older trials of the same rates; the summary, None where nothing is on record.

    Raises OSError where it cannot be written.
    """
    trials = _kept(path, host) | {one.figures.period_ns: plain(one) for one in tried if is_evidence(one.figures)}
    if not trials:
        return None
    found = summary(trials)
    record = {"host": host._asdict(), "summary": found._asdict(), "trials": [*trials.values()]}
    text = json.dumps(record | {"source_version": source_version()}, indent=2)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".{os.getpid()}")
    part.write_text(text + "\n")
    part.replace(path)
    return found


def _kept(path: Path, host: Host) -> dict[int, dict[str, Any]]:
    """Trials on record, by period; none where the record cannot be used."""
    try:
        record = json.loads(path.read_text())
        trials = {int(trial["period_ns"]): trial for trial in record["trials"]} if record["host"] == host._asdict() else {}
        if trials:
            summary(trials)
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return {}
    return trials


def summary(trials: dict[int, dict[str, Any]]) -> Qualified:
    """What is quoted of a record. Raises KeyError where a trial lacks a figure."""
    verdicts = {period_ns: Verdict(trial["grade"], trial["qualified"], ()) for period_ns, trial in trials.items()}
    decided = trials[deciding_period_ns(verdicts)]
    lease = decided["lease_ns"]
    return Qualified(
        qualified_period_ns=qualified_period_ns(verdicts),
        grade=decided["grade"],
        measured_at=decided["measured_at"],
        period_ns=decided["period_ns"],
        samples=decided["samples"],
        late_share=decided["late_share"],
        accepted_p999_us=decided["accepted_us"]["p999"],
        wake_up_max_us=decided["wake_ups_us"]["max"],
        lease_ms=None if lease is None else lease / _NS_PER_MS,
    )
