"""`hydrohil faults`: the fault test, as a page, a JUnit file and an exit status."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrohil.cli.options import CONFIDENCE, CellName, Port, app, console, fail, make_folders, writing
from hydrohil.cli.reproduce_command import write_whole
from hydrohil.shared.exit_status import EXIT_USAGE

if TYPE_CHECKING:  # the page's libraries load when it is written
    from hydrohil.faulttest.report import Report
    from hydrohil.faulttest.run import FaultTestProgress


@app.command(rich_help_panel=CONFIDENCE)
def faults(
    rows: Annotated[list[str] | None, typer.Argument(help="Numbers of faults (1, 5b); default: all.")] = None,
    only: Annotated[list[str] | None, typer.Option("--only", metavar="NUMBER", help="The same: --only 1 5b 20.")] = None,
    trials: Annotated[int, typer.Option(min=1, max=1000, help="Trials of each fault with real processes.")] = 5,
    quick: Annotated[bool, typer.Option("--quick", help="Without the wall clock: local clock, lockstep and tests.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Of phases, noise and jitter.")] = 0,
    listed: Annotated[bool, typer.Option("--list", help="Show faults, bounds and how each is tried; start nothing.")] = False,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write every number; with --list the list, - prints it.")
    ] = None,
    html: Annotated[Path, typer.Option(help="Write the page.")] = Path("runs/faults/faults.html"),
    junit_file: Annotated[Path, typer.Option("--junit", help="Write a case a way.")] = Path("runs/faults/junit.xml"),
    permit_ttl_ms: Annotated[float | None, typer.Option(help="Lease; default: chosen from this host's lateness.")] = None,
    realtime: Annotated[bool, typer.Option(help="Ask for real-time scheduling.")] = True,
    cell: CellName = "faults",
    port: Port = 7650,
) -> None:
    """Break everything that can break, and measure how long it takes until the valves are at zero.

    The fault test brings up cells of its own and ends them. Exit status: 0 every fault that was tried is survived, 1 one is not,
    2 usage, 130 interrupted (what is complete is written).

    Examples: `hydrohil faults --list`, `hydrohil faults`, `hydrohil faults --quick`,
    `hydrohil faults --only 1 2 4 5 5b --trials 50`
    """
    from hydrohil.cli import faults_list
    from hydrohil.faulttest.matrix import UnknownRowError, find_rows

    numbers = [*(only or []), *(rows or [])]
    try:
        chosen = find_rows(numbers)
    except UnknownRowError as error:
        raise fail(error, EXIT_USAGE) from None
    if listed:
        return faults_list.show(chosen) if json_file is None else faults_list.write_json(chosen, json_file)
    make_folders(json_file, html, junit_file)
    options = [f"--trials {trials}", f"--seed {seed}"] + ["--quick"] * quick
    command = " ".join(["hydrohil faults", *(["--only", *numbers] if numbers else []), *options])
    with _Bar() as bar:
        from hydrohil.cell.processes import Place
        from hydrohil.faulttest.run import run_fault_tests

        report = run_fault_tests(
            numbers,
            trials=trials,
            seed=seed,
            quick=quick,
            place=Place(cell, port),
            realtime=realtime,
            lease_ms=permit_ttl_ms,
            trips_folder=html.parent / "trips",
            progress=bar.show,
        )
    _finish(report._replace(command=command), json_file, html, junit_file)


class _Bar:
    """A bar over all trials; a fault that is not survived is printed above it at once."""

    def __init__(self) -> None:
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
        self._progress = Progress(*columns, console=console)
        self._task = self._progress.add_task("starting; compiles once after a change", total=None)

    def __enter__(self) -> "_Bar":
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def show(self, now: "FaultTestProgress") -> None:
        """One report of the fault test."""
        self._progress.update(self._task, description=now.title, completed=now.done, total=now.total)
        if now.trial is not None and not now.trial.held:
            self._progress.console.print(f"[red bold]NOT SURVIVED[/] {now.title}: {now.trial.words}", highlight=False)


def _finish(report: "Report", json_file: Path | None, html: Path, junit_file: Path) -> None:
    """Say what was found, write the files, end with the status."""
    from hydrohil.faulttest.junit import junit
    from hydrohil.faulttest.page import page
    from hydrohil.faulttest.report import to_json

    _show(report, html)  # before the files, so that a full disk does not hide the verdicts
    texts = {html: page(report), junit_file: junit(report)}
    if json_file is not None:
        texts[json_file] = to_json(report)
    for path, text in texts.items():
        with writing(path):
            write_whole(path, text)
    if report.interrupted:
        raise fail("interrupted: what was complete is written", 130)
    raise typer.Exit(report.exit_status)


def _show(report: "Report", html: Path) -> None:
    from rich.table import Table

    from hydrohil.faulttest.report import amount, milliseconds
    from hydrohil.reproduction.formatting import duration

    table = Table("#", "fault", "tried", "held", "median", "worst", "bound ms", "mm", "N", "verdict")
    for result in report.results:
        for place, tried in enumerate(result.tried):
            first = (result.row.number, result.row.fault) if place == 0 else ("", "")
            held = f"{tried.held}/{len(tried.trials)}" if tried.trials else ""
            times = (tried.middle("reaction_s"), tried.worst("reaction_s"), tried.worst("bound_s"))
            went = (tried.worst("moved_mm"), tried.worst("force_n"))
            way = f"{tried.way.letter}: {tried.way.words}"
            table.add_row(*first, way, held, *map(milliseconds, times), *map(amount, went), tried.verdict)
    console.print(table)
    lease = f"; lease {report.lease_ms:.1f} ms" if math.isfinite(report.lease_ms) else ""
    again = f"; started again: {len(report.restarted)}" if report.restarted else ""
    console.print(f"{report.headline}{lease}{again}; {duration(report.duration_s)}; {html}", soft_wrap=True, highlight=False)
