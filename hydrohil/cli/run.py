"""What `hydrohil run` shows while a run goes on, and where its files go."""

from collections.abc import Callable
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from hydrohil.cell.cell import Cell, Clock
from hydrohil.cell.processes import CellError
from hydrohil.claims.trace_files import write_trace
from hydrohil.cli.options import errors, writing
from hydrohil.cli.report import show_trip
from hydrohil.experiment.experiment import Experiment, warnings
from hydrohil.experiment.run import Run
from hydrohil.recording.trips import TRIPS, write_trip
from hydrohil.shared.trips.report import Document
from hydrohil.simulation.simulate import simulate

WAITING = "waiting for the cell: it measures this host for two seconds"


def noted(console: Console) -> Callable[[str], None]:
    """Prints a line for an operator; what kind of line it is stands before its colon."""

    def note(line: str) -> None:
        kind, _, words = line.partition(": ")
        console.print(kind, end=": ", highlight=False, markup=False, style="" if kind == "note" else "yellow")
        console.print(words, highlight=False, markup=False, soft_wrap=True)

    return note


def run_local(experiment: Experiment, seed: int, console: Console) -> Run:
    """One run on the local clock."""
    _warn(experiment, console)
    with console.status("running (the first run after a change compiles)"):
        return simulate(experiment, seed)


def run_live(
    open_cell: Callable[[], Cell],
    experiment: Experiment,
    seed: int,
    clock: Clock,
    record: Path | None,
    console: Console,
    *,
    unqualified: bool,
) -> Run:
    """One run in a cell, with a bar; a trip that ends it without a result is shown. Raises CellError."""
    _warn(experiment, console)
    with console.status(WAITING):
        cell = open_cell()
    with cell, _progress(console) as progress:
        task = progress.add_task(experiment.name, total=experiment.duration_s)
        try:
            return cell.run(
                experiment,
                seed,
                clock=clock,
                record=record,
                unqualified=unqualified,
                progress=lambda trial_s: progress.update(task, completed=max(0.0, trial_s)),
                note=noted(progress.console),
            )
        except CellError as error:
            if error.trip_report is not None:
                progress.stop()
                show_trip(console, error.trip_report, error.trip_file or kept_file(error.trip_report))
            raise


def kept(run: Run, trace_file: Path | None) -> Run:
    """The run with its trace and its trip's report written, where there are any."""
    if trace_file is not None and run.trace is not None:
        with writing(trace_file):
            write_trace(run.trace, trace_file)
    if run.trip_report is None or run.trip_file:
        return run
    return run._replace(trip_file=kept_file(run.trip_report))


def kept_file(document: Document) -> str:
    """Where a trip's report was written; "" with a line on stderr where that fails."""
    try:
        return str(write_trip(document))
    except OSError as error:
        errors.print(f"{TRIPS}: the trip report cannot be written ({error.strerror or error})", markup=False)
        return ""


def _warn(experiment: Experiment, console: Console) -> None:
    for line in warnings(experiment):
        noted(console)(f"warning: {line}")


def _progress(console: Console) -> Progress:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:.1f} of {task.total:.1f} s"),
        TimeRemainingColumn(),
    )
    return Progress(*columns, console=console)
