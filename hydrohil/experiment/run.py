"""One run of an experiment, judged: its trace, the verdict on each claim, and how it ended."""

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from hydrohil.claims.claims import Verdict, band, judge, quantity
from hydrohil.claims.trace import Trace
from hydrohil.claims.trace_files import columns
from hydrohil.experiment.experiment import Experiment
from hydrohil.shared.compiled.kernel import source_version
from hydrohil.shared.contract.faults import words
from hydrohil.shared.errors import MissingPackageError
from hydrohil.shared.exit_status import EXIT_CLAIM, EXIT_OK, EXIT_TRANSPORT, EXIT_TRIPPED
from hydrohil.shared.host.qualified import of_plain

if TYPE_CHECKING:
    import pandas

BY_HAND = "parameters were changed by hand, so that this was not the experiment that the claims are about"


class Run(NamedTuple):
    """What `simulate` and `Cell.run` return. A run that tripped, has a gap or was changed by hand has no verdict."""

    experiment: Experiment
    clock: str  # local, lockstep or real
    seed: int  # of noise, jitter and faults
    trace: Trace | None = None  # a row a sample from tick 0; None if a message of it is missing
    verdicts: tuple[Verdict, ...] = ()  # one a claim, in their order; none after a trip
    trip: str = ""  # why the rig tripped, in words; "" if it did not
    gap: str = ""  # what is missing of the trace, in words
    wall_s: float = 0.0  # how long it took
    latencies: dict[str, Any] | None = None  # the plant's counters after a live run, times in us
    recording: str = ""  # file of the recording
    warnings: tuple[str, ...] = ()  # what was to be known before, a line each
    process_faults: tuple[str, ...] = ()  # faults of processes that were carried out, and when
    changed_by_hand: tuple[str, ...] = ()  # parameters that were changed while it ran, and when
    trip_report: dict[str, Any] | None = None  # why and how, with the last 10 s of all signals; as `read_trip` reads it
    trip_file: str = ""  # where the recorder has written that report
    qualification: dict[str, Any] | None = None  # what is on record of the host of a live run

    def __repr__(self) -> str:
        """One line for a notebook; the arrays are in `trace`."""
        return f"<Run {self.experiment.name}, seed {self.seed}, clock {self.clock}: {self.outcome}>"

    @property
    def outcome(self) -> str:
        """How it ended, in a few words."""
        if self.trip:
            return f"TRIPPED, {self.trip}"
        if self.gap or self.changed_by_hand:
            return f"no verdict, {self.gap or BY_HAND}"
        return f"{sum(verdict.holds for verdict in self.verdicts)} of {len(self.verdicts)} claims hold"

    @property
    def holds(self) -> bool:
        """Whether the trial reached its end, unchanged and without a gap, and all of its claims hold."""
        return self.exit_status == EXIT_OK

    @property
    def exit_status(self) -> int:
        """As `hydrohil run` ends: 3 tripped, 5 no verdict (a gap, changed by hand), 1 a claim fails, 0 all hold."""
        if self.trip:
            return EXIT_TRIPPED
        if self.gap or self.changed_by_hand:
            return EXIT_TRANSPORT
        return EXIT_OK if all(verdict.holds for verdict in self.verdicts) else EXIT_CLAIM

    def to_pandas(self) -> "pandas.DataFrame":
        """The trace as a data frame: a row a sample, indexed by `t_s`, a column a link (`q.down_up`) or axis (`x_m.z`).

        Raises MissingPackageError where pandas is not installed, ValueError where the run has no trace.
        """
        try:
            import pandas
        except ImportError:
            raise MissingPackageError("a data frame needs pandas: `pip install pandas`; `run.trace` has numpy arrays") from None
        if self.trace is None:
            raise ValueError(f"{self.experiment.name}: this run has no trace ({self.gap})")
        return pandas.DataFrame(columns(self.trace)).set_index("t_s")

    def report(self) -> dict[str, Any]:
        """Everything but the trace and the signals, for JSON: what `hydrohil run --json` writes."""
        return _report(self)

    def to_markdown(self) -> str:
        """Experiment, verdicts and how it ended, as the document that a recording carries."""
        return "\n".join((*_headings(self), *map(_row, self.verdicts)))


def verdicts_of(experiment: Experiment, trace: Trace | None, trip: str) -> tuple[Verdict, ...]:
    """The verdict on every claim; none without a trace or after a trip."""
    return () if trace is None or trip else tuple(judge(claim, trace) for claim in experiment.claims)


def _headings(run: Run) -> list[str]:
    experiment = run.experiment
    lines = [f"# {experiment.name}: {experiment.title}", "", experiment.source, ""]
    lines += [f"clock {run.clock}, seed {run.seed}, source {source_version()}", ""]
    lines += [f"**TRIPPED**: {run.trip}", ""] if run.trip else []
    lines += [f"**NO VERDICT**: {run.gap}", ""] if run.gap else []
    lines += [f"**broken on purpose**: {words(fault)}\n" for fault in experiment.faults]
    lines += [f"**process fault**: {line}\n" for line in run.process_faults]
    lines += [f"**scheduled** at {change.at_s:g} s: {', '.join(change.set)}\n" for change in experiment.changes]
    if run.changed_by_hand:
        lines += [f"**NO VERDICT**: {BY_HAND}\n", *(f"**by hand**: {line}\n" for line in run.changed_by_hand)]
    lines += [f"**warning**: {line}\n" for line in run.warnings]
    return [*lines, "| claim | stated | measured | holds |", "|---|---|---|---|"]


def _row(verdict: Verdict) -> str:
    claim = verdict.claim
    measured = quantity(verdict.measured, claim.unit, 3)
    return f"| {claim.statement} | {band(claim)} | {measured} | {'yes' if verdict.holds else '**NO**'} |"


def _report(run: Run) -> dict[str, Any]:
    return {
        "experiment": run.experiment.name,
        "alias": run.experiment.alias,
        "clock": run.clock,
        "seed": run.seed,
        "source_version": source_version(),
        "exit_status": run.exit_status,
        "tripped": run.trip or None,
        "trip": run.trip_report and {name: value for name, value in run.trip_report.items() if name != "signals"},
        "trip_report": run.trip_file or None,
        "gap": run.gap or None,
        "wall_s": run.wall_s,
        "latencies": run.latencies or None,
        "recording": run.recording or None,
        "qualification": run.qualification,
        "qualified": None if run.clock == "local" else of_plain(run.qualification).words,
        "warnings": list(run.warnings),
        "faults": [fault._asdict() for fault in run.experiment.faults],
        "process_faults": list(run.process_faults),
        "changes": [change._asdict() for change in run.experiment.changes],
        "changed_by_hand": list(run.changed_by_hand),
        "claims": [_claim(verdict) for verdict in run.verdicts],
    }


def _claim(verdict: Verdict) -> dict[str, Any]:
    return {
        "statement": verdict.claim.statement,
        "source": verdict.claim.source,
        "stated": band(verdict.claim),
        "measured": verdict.measured if math.isfinite(verdict.measured) else None,
        "unit": verdict.claim.unit,
        "holds": verdict.holds,
    }
