"""`hydrohil run`: on the local clock in this process, otherwise in a cell that runs or is brought up for the run."""

import time
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from hydrohil.cell import processes as cells
from hydrohil.cell.connection import found_or_own_cell
from hydrohil.cell.session import Live, run_live
from hydrohil.cell.trip_file import kept_file
from hydrohil.claims.claims import Verdict, judge
from hydrohil.claims.trace import Trace, save
from hydrohil.cli.options import writing
from hydrohil.cli.report import Report, markdown, show_trip
from hydrohil.experiment.experiment import Experiment, warnings
from hydrohil.reproduction.play import played
from hydrohil.shared.host.qualified import NOT_QUALIFIED
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.trips.report import Document
from hydrohil.simulation.rollout import play_local
from hydrohil.simulation.trip_local import local_report


class Wanted(NamedTuple):
    """What the command line asks for."""

    experiment: Experiment
    clock: str
    seed: int
    rrd: Path | None
    trace: Path | None
    extra: dict[str, list[str]]
    unqualified: bool = False  # above the rate that this host is qualified for, on purpose


def run_experiment(place: cells.Place, wanted: Wanted, console: Console) -> Report:
    """The report of one run, after its warnings; raises CellError if there is no cell to run in."""
    _warn(console, warnings(wanted.experiment))
    return _local(wanted, console) if wanted.clock == "local" else _in_cell(place, wanted, console)


def _warn(console: Console, lines: Iterable[str]) -> None:
    for line in lines:
        console.print(f"[yellow]warning[/]: {escape(line)}", highlight=False, soft_wrap=True)


def _local(wanted: Wanted, console: Console) -> Report:
    began = time.perf_counter()
    with console.status("running (the first run after a change compiles)"):
        outcome = play_local(wanted.experiment, wanted.seed)
    made = played(outcome)
    report = _report(wanted, made.trace, made.tripped, "", time.perf_counter() - began, {})
    return _with_trip(report, local_report(wanted.experiment, outcome), None)


def _in_cell(place: cells.Place, wanted: Wanted, console: Console) -> Report:
    with ExitStack() as stack:
        with console.status("waiting for the cell: it measures this host for two seconds"):
            bus = stack.enter_context(found_or_own_cell(place, wanted.extra))
        return _run_and_record(bus, wanted, console)


def _run_and_record(bus: Bus, wanted: Wanted, console: Console) -> Report:
    told = cells.ask(bus, "supervisor", "status")
    if wanted.clock == "real" and told.get("qualification") is None:
        _note(console, told)
    recorded = _start_recording(bus, wanted, console, told.get("qualification"))
    trips: list[Document] = []
    began = time.perf_counter()
    try:
        with _progress(console) as progress:
            task = progress.add_task(wanted.experiment.name, total=wanted.experiment.duration_s)
            live = run_live(
                bus,
                wanted.experiment,
                wanted.seed,
                wanted.clock,
                lambda t: progress.update(task, completed=max(0.0, t)),
                trips.append,
                unqualified=wanted.unqualified,
            )
    except (KeyboardInterrupt, cells.CellError):
        if recorded:
            bus.ask("recorder", "finish", {"summary_markdown": f"# {wanted.experiment.name}: ended early, no verdict"}, 10.0)
        for document in trips:
            show_trip(console, document, kept_file(document, bus))
        raise
    wall_s = time.perf_counter() - began
    report = _report(wanted, live.trace, live.tripped, live.gap, wall_s, _latencies(live))
    report = report._replace(struck=live.struck, changed=live.changed, qualification=told.get("qualification"))
    of_cell = tuple(line for line in live.warnings if line not in report.warnings)
    _warn(console, of_cell)
    report = report._replace(warnings=report.warnings + of_cell)
    if recorded:
        report = report._replace(recording=_finish_recording(bus, report, console))
    return _with_trip(report, trips[0] if trips else None, bus)


def _with_trip(report: Report, document: Document | None, bus: Bus | None) -> Report:
    return report if document is None else report._replace(trip=document, trip_file=kept_file(document, bus))


def _progress(console: Console) -> Progress:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:.1f} of {task.total:.1f} s"),
        TimeRemainingColumn(),
    )
    return Progress(*columns, console=console)


def _note(console: Console, told: dict[str, Any]) -> None:
    console.print(f"note: {told.get('qualified', NOT_QUALIFIED)}", highlight=False, markup=False, soft_wrap=True)


def _start_recording(bus: Bus, wanted: Wanted, console: Console, qualification: Any) -> bool:
    """Ask the recorder; a cell without one runs on and says so."""
    if wanted.rrd is None:
        return False
    title = f"{wanted.experiment.name}: {wanted.experiment.title}"
    try:
        made = cells.ask(
            bus,
            "recorder",
            "record",
            10.0,
            path=str(wanted.rrd.resolve()),
            title=title,
            summary_markdown=f"# {title}",
            qualification=qualification,
        )
    except cells.CellError as error:
        console.print(f"[yellow]no recording[/]: {error}", highlight=False)
        return False
    if made.get("failure"):
        console.print(f"[yellow]the recording is incomplete[/]: {made['failure']}", highlight=False)
    return True


def _finish_recording(bus: Bus, report: Report, console: Console) -> str:
    try:
        made = cells.ask(bus, "recorder", "finish", 30.0, summary_markdown=markdown(report))
    except cells.CellError as error:
        console.print(f"[yellow]the recorder was lost during the run[/]: {error}", highlight=False)
        return ""
    for problem in (made.get("failure"), f"{made['gaps']} messages are missing in it" if made.get("gaps") else ""):
        if problem:
            console.print(f"[yellow]the recording is incomplete[/]: {problem}", highlight=False)
    return str(made.get("path", ""))


def _latencies(live: Live) -> dict[str, Any]:
    counters: dict[str, Any] = live.status.get("plant", {}).get("counters", {})
    return counters


def _report(wanted: Wanted, trace: Trace | None, tripped: str, gap: str, wall_s: float, latencies: dict[str, Any]) -> Report:
    """Judge the trace and write it."""
    verdicts: tuple[Verdict, ...] = ()
    if trace is not None:
        if wanted.trace is not None:
            with writing(wanted.trace):
                save(trace, wanted.trace)
        if not tripped:
            verdicts = tuple(judge(claim, trace) for claim in wanted.experiment.claims)
    told = warnings(wanted.experiment)
    return Report(wanted.experiment, wanted.clock, wanted.seed, verdicts, tripped, gap, wall_s, latencies, "", told)
