"""`hydrohil faults`: the fault battery, as a page, a JUnit file and an exit status."""

import math
import time
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrohil.cli.options import CONFIDENCE, CellName, Port, app, console, fail, make_folders, writing
from hydrohil.cli.reproduce_command import write_whole
from hydrohil.shared.exit_status import EXIT_USAGE

if TYPE_CHECKING:  # the page's libraries load when it is made
    from hydrohil.faulttest.report import Report
    from hydrohil.faulttest.trial import Row, Trial

LOCKSTEP_PORTS = 12  # beyond those of the other cells that a battery may have
FIRST_PORT = 7650  # beside a cell that is up: the battery has one of its own


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
    port: Port = FIRST_PORT,
) -> None:
    """Break everything that can break, and measure how long it takes until the valves are at zero.

    The battery brings up a cell of its own and ends it. Exit status: 0 every fault that was tried is survived, 1 one is not,
    2 usage, 130 interrupted (what is complete is written).

    Examples: `hydrohil faults --list`, `hydrohil faults`, `hydrohil faults --quick`,
    `hydrohil faults --only 1 2 4 5 5b --trials 50`
    """
    from hydrohil.cell.connection import service_options
    from hydrohil.cli import faults_list
    from hydrohil.faulttest.matrix import find_rows
    from hydrohil.shared.compiled.kernel import source_version

    wanted = [*(only or []), *(rows or [])]
    try:
        chosen = find_rows(wanted)
    except LookupError as error:
        raise fail(error.args[0], EXIT_USAGE) from None
    if listed:
        return faults_list.show(chosen) if json_file is None else faults_list.write_json(chosen, json_file)
    make_folders(json_file, html, junit_file)
    options = [f"--trials {trials}", f"--seed {seed}"] + ["--quick"] * quick
    command = " ".join(["hydrohil faults", *(["--only", *wanted] if wanted else []), *options])
    extra = service_options(permit_ttl_ms, realtime=realtime) | {"recorder": ["--trips", str(html.parent / "trips")]}
    report = _play(chosen, cell, port, (trials, seed, quick), extra)
    report = report._replace(source_version=source_version(), command=command)
    _finish(report, json_file, html, junit_file)


def _play(
    chosen: "tuple[Row, ...]", cell: str, port: int, wished: tuple[int, int, bool], extra: dict[str, list[str]]
) -> "Report":
    """The battery with a bar; a Ctrl-C ends it with what is complete."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from hydrohil.cell.processes import Place
    from hydrohil.faulttest.report import Report
    from hydrohil.faulttest.rig import Rig, lockstep_extra
    from hydrohil.faulttest.run import FaultTest, Wish, total
    from hydrohil.reproduction.report import machine

    wish, began, interrupted = Wish(*wished), time.perf_counter(), False
    again: list[str] = []
    made = datetime.now().astimezone().isoformat(" ", "seconds")
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    stepped = Rig(Place(f"{cell}-lockstep", port + LOCKSTEP_PORTS), lockstep_extra(extra), again.append)
    rig = Rig(Place(cell, port), extra, again.append)
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("starting; compiles once after a change", total=total(chosen, wish))

        def show(title: str, trial: "Trial | None") -> None:
            progress.update(task, description=title, advance=0 if trial is None else 1)
            if trial is not None and not trial.held:
                progress.console.print(f"[red bold]NOT SURVIVED[/] {title}: {trial.words}", highlight=False)

        battery = FaultTest(chosen, {"L": stepped, "W": rig}, wish, show)
        try:
            battery.play()
        except KeyboardInterrupt:
            interrupted = True
    results, took_s = battery.results(), time.perf_counter() - began
    return Report(results, wish.trials, wish.seed, rig.lease_ms, interrupted, "", made, took_s, machine(), "", tuple(again))


def _finish(report: "Report", json_file: Path | None, html: Path, junit_file: Path) -> None:
    """Say what was found, write the files, end with the status."""
    from hydrohil.faulttest.junit import junit
    from hydrohil.faulttest.page import page
    from hydrohil.faulttest.report import to_json

    _show(report, html)  # first: a full disk takes the files, not the verdicts
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
    again = f"; begun again: {len(report.begun_again)}" if report.begun_again else ""
    console.print(f"{report.headline}{lease}{again}; {duration(report.duration_s)}; {html}", soft_wrap=True, highlight=False)
