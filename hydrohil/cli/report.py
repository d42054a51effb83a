"""What a run prints and writes: claims (stated, measured, holds), latencies, how it ended."""

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

from rich.console import Console
from rich.table import Table

from hydrohil.claims.claims import Verdict, band, quantity
from hydrohil.experiment.experiment import Experiment
from hydrohil.shared.compiled.kernel import source_version
from hydrohil.shared.contract.faults import words
from hydrohil.shared.exit_status import EXIT_CLAIM, EXIT_OK, EXIT_TRANSPORT, EXIT_TRIPPED
from hydrohil.shared.host.qualified import of_plain
from hydrohil.shared.trips import formatting as trip_words
from hydrohil.shared.trips.report import Document

BY_HAND = "parameters were changed by hand, so that this was not the experiment that the claims are about"


class Report(NamedTuple):
    """One run, judged."""

    experiment: Experiment
    clock: str
    seed: int
    verdicts: tuple[Verdict, ...]
    tripped: str
    gap: str
    wall_s: float
    latencies: dict[str, Any]  # of a live run
    recording: str
    warnings: tuple[str, ...] = ()  # told before the run
    struck: tuple[str, ...] = ()  # faults of processes that were carried out
    changed: tuple[str, ...] = ()  # parameters that were changed by hand: no verdict
    trip: Document | None = None
    trip_file: str = ""
    qualification: dict[str, Any] | None = None  # of the host of a live run

    @property
    def exit_status(self) -> int:
        """3 tripped, 5 no verdict (a gap, changed by hand), 1 a claim fails, 0 all hold."""
        if self.tripped:
            return EXIT_TRIPPED
        if self.gap or self.changed:
            return EXIT_TRANSPORT
        return EXIT_OK if all(verdict.holds for verdict in self.verdicts) else EXIT_CLAIM


def show(console: Console, report: Report) -> None:
    """The tables."""
    experiment = report.experiment
    console.print(f"[bold]{experiment.name}[/] ({experiment.alias}): {experiment.title}", highlight=False)
    console.print(
        f"clock {report.clock}, seed {report.seed}, {experiment.duration_s:g} s in {report.wall_s:.2f} s "
        f"({experiment.duration_s / report.wall_s:.3g} times real time)",
        highlight=False,
    )
    for fault in experiment.faults:
        console.print(f"[yellow]broken on purpose[/]: {words(fault)}", highlight=False)
    for line in report.struck:
        console.print(f"struck: {line}", highlight=False, markup=False)
    for change in experiment.changes:
        console.print(f"at {change.at_s:g} s: {', '.join(change.set)}", highlight=False, markup=False)
    for line in report.changed:
        console.print(line, highlight=False, soft_wrap=True, markup=False, style="yellow")
    if report.tripped:
        console.print(f"[red bold]TRIPPED[/]: {report.tripped}", highlight=False)
    if report.trip is not None:
        show_trip(console, report.trip, report.trip_file)
    if report.gap:
        console.print(f"[red bold]NO VERDICT[/]: {report.gap}; every tick is needed", highlight=False)
    if report.changed:
        console.print(f"[red bold]NO VERDICT[/]: {BY_HAND}", highlight=False)
    if report.verdicts:
        console.print(claims_table(report.verdicts))
    if report.latencies:
        console.print(latency_table(report.latencies))
    if report.recording:
        console.print(f"recording: {report.recording}  (hydrohil view {report.recording})", highlight=False, soft_wrap=True)


def show_trip(console: Console, document: Document, file: str) -> None:
    """A trip's report, and where its file is."""
    for line in trip_words.lines(document):
        console.print(line, highlight=False, soft_wrap=True, markup=False)
    if file:
        console.print(f"trip report: {file}  (hydrohil trip {file})", highlight=False, soft_wrap=True)


def claims_table(verdicts: tuple[Verdict, ...]) -> Table:
    """Stated, measured, holds."""
    table = Table(title="claims", title_justify="left")
    for column in ("claim", "stated", "measured", "holds"):
        table.add_column(column, overflow="fold")
    for verdict in verdicts:
        mark = "[green]yes[/]" if verdict.holds else "[red]NO[/]"
        table.add_row(verdict.claim.statement, band(verdict.claim), quantity(verdict.measured, verdict.claim.unit, 3), mark)
    return table


def latency_table(latencies: dict[str, Any]) -> Table:
    """Latency and lateness of a live run, in us; counts of what was not in time."""
    table = Table(title="latencies", title_justify="left")
    for column in ("", "p50 us", "p99 us", "max us"):
        table.add_column(column, justify="left" if not column else "right")
    for name, key in (
        ("sample -> command accepted", "sample_to_accepted_us"),
        ("lateness of the plant's wake-ups", "lateness_us"),
    ):
        values = latencies.get(key) or {}
        table.add_row(name, *(f"{values[p]:.0f}" if p in values else "-" for p in ("p50", "p99", "max")))
    for key in ("samples", "late_commands", "unanswered", "late_permits", "grid_shifts"):
        if key in latencies:
            table.add_row(key.replace("_", " "), str(latencies[key]), "", "")
    return table


def markdown(report: Report) -> str:
    """The verdict as the recording's document."""
    lines = [f"# {report.experiment.name}: {report.experiment.title}", "", report.experiment.source, ""]
    lines += [f"clock {report.clock}, seed {report.seed}, source {source_version()}", ""]
    lines += [f"**TRIPPED**: {report.tripped}", ""] if report.tripped else []
    lines += [f"**NO VERDICT**: {report.gap}", ""] if report.gap else []
    lines += [f"**broken on purpose**: {words(fault)}\n" for fault in report.experiment.faults]
    lines += [f"**struck**: {line}\n" for line in report.struck]
    lines += [f"**scheduled** at {change.at_s:g} s: {', '.join(change.set)}\n" for change in report.experiment.changes]
    lines += [f"**NO VERDICT**: {BY_HAND}\n", *(f"**by hand**: {line}\n" for line in report.changed)] if report.changed else []
    lines += [f"**warning**: {line}\n" for line in report.warnings]
    lines += ["| claim | stated | measured | holds |", "|---|---|---|---|"]
    lines += [
        f"| {v.claim.statement} | {band(v.claim)} | {quantity(v.measured, v.claim.unit, 3)} | {'yes' if v.holds else '**NO**'} |"
        for v in report.verdicts
    ]
    return "\n".join(lines)


def write_json(path: Path, report: Report) -> None:
    """The report for a machine."""
    path.write_text(
        json.dumps(
            {
                "experiment": report.experiment.name,
                "alias": report.experiment.alias,
                "clock": report.clock,
                "seed": report.seed,
                "source_version": source_version(),
                "exit_status": report.exit_status,
                "tripped": report.tripped or None,
                "trip": report.trip and {name: value for name, value in report.trip.items() if name != "signals"},
                "trip_report": report.trip_file or None,
                "gap": report.gap or None,
                "wall_s": report.wall_s,
                "latencies": report.latencies or None,
                "recording": report.recording or None,
                "qualification": report.qualification,
                "qualified": None if report.clock == "local" else of_plain(report.qualification).words,
                "warnings": list(report.warnings),
                "faults": [fault._asdict() for fault in report.experiment.faults],
                "struck": list(report.struck),
                "changes": [change._asdict() for change in report.experiment.changes],
                "changed_by_hand": list(report.changed),
                "claims": [
                    {
                        "statement": v.claim.statement,
                        "source": v.claim.source,
                        "stated": band(v.claim),
                        "measured": v.measured if math.isfinite(v.measured) else None,
                        "unit": v.claim.unit,
                        "holds": v.holds,
                    }
                    for v in report.verdicts
                ],
            },
            indent=2,
        )
        + "\n"
    )
