"""`hydrohil reproduce`: every figure and every claim again, as a page, a JUnit file and an exit status."""

import math
import os
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrohil.cli.options import (
    EXPERIMENTS,
    CellName,
    Hosts,
    Port,
    Router,
    Unqualified,
    app,
    console,
    fail,
    failing,
    make_folders,
    writing,
)
from hydrohil.shared.exit_status import EXIT_USAGE
from hydrohil.shared.transport.endpoints import DEFAULT_PORT

if TYPE_CHECKING:  # the page's libraries load when it is rendered
    from hydrohil.cell.cell import Cell
    from hydrohil.reproduction.plan import Figure
    from hydrohil.reproduction.report import Report

PAGE, JUNIT = "reproduction.html", "junit.xml"


@app.command(rich_help_panel=EXPERIMENTS)
def reproduce(
    figures: Annotated[list[str] | None, typer.Argument(help="Chapters (4, appendix), figures or aliases; default: all.")] = None,
    only: Annotated[list[str] | None, typer.Option("--only", metavar="WHAT", help="The same: --only 5 7 fig-4-25.")] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Noise seeds; a claim must hold in 95 % of them.")] = 1,
    clock: Annotated[str, typer.Option(help="local, lockstep or real.")] = "local",
    out: Annotated[Path, typer.Option(help=f"Folder of {PAGE} and {JUNIT}.")] = Path("runs/reproduce"),
    json_file: Annotated[Path | None, typer.Option("--json", help="Write every number.")] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes of the local clock; default: one a core.")] = None,
    cell: CellName = "cell",
    port: Port = DEFAULT_PORT,
    hosts: Hosts = "",
    router: Router = "",
    permit_ttl_ms: Annotated[float | None, typer.Option(help="Lease of a cell brought up for this.")] = None,
    realtime: Annotated[bool, typer.Option(help="Real-time scheduling of a cell brought up for this.")] = True,
    unqualified: Unqualified = False,
) -> None:
    """Try every figure of the thesis again: one page with plots and verdicts, and a JUnit file.

    Exit status: 0 all claims hold, 1 a claim fails, 2 usage, 3 a trial tripped, 5 transport. In a cell the first trip ends it.

    Examples: `hydrohil reproduce`, `hydrohil reproduce --only 5 7 --seeds 20`, `hydrohil reproduce fig-4-25 --clock real`
    """
    from hydrohil.reproduction import plan

    names = [*(only or []), *(figures or [])]
    with failing():
        chosen = plan.choose(names)
    _usable(clock, names, chosen, seeds)
    make_folders(out / PAGE, out / JUNIT, json_file)
    with failing("interrupted: nothing was written"), ExitStack() as stack:
        found = None
        if clock != "local":
            found = stack.enter_context(_opened(cell, port, hosts, router, permit_ttl_ms, realtime=realtime))
        report = _with_bar(names, seeds, clock, workers, found, unqualified=unqualified)
    _finish(report, out, json_file)


def _usable(clock: str, names: list[str], chosen: "tuple[Figure, ...]", seeds: int) -> None:
    """Refuse a clock that does not exist, and a live clock for everything; say how long a live one takes."""
    from hydrohil.reproduction.formatting import duration
    from hydrohil.reproduction.reproduce import CLOCKS, live_s

    if clock not in CLOCKS:
        raise fail(f"--clock is {clock!r}: expected local, lockstep or real", EXIT_USAGE)
    if clock == "local":
        return
    trials, takes = {name for figure in chosen for name in figure.trials}, duration(live_s(chosen, seeds))
    if not names:
        raise fail(f"--clock {clock}: {len(trials)} trials take {takes} at real speed: choose some with --only", EXIT_USAGE)
    console.print(f"clock {clock}: {takes} at real speed; trials: {len(trials)}, seeds: {seeds}", highlight=False)


def _opened(cell: str, port: int, hosts: str, router: str, lease_ms: float | None, *, realtime: bool) -> "Cell":
    from hydrohil.cell.cell import Cell
    from hydrohil.cli.run import WAITING

    with console.status(WAITING):
        return Cell.open(cell, port, hosts=hosts, router=router, lease_ms=lease_ms, realtime=realtime, recorder=False)


def _with_bar(
    names: list[str], seeds: int, clock: str, workers: int | None, cell: "Cell | None", *, unqualified: bool
) -> "Report":
    """The figures again, with a bar that knows how long each takes."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from hydrohil.reproduction.reproduce import ReproductionProgress, reproduce

    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:.0f} %"), TimeRemainingColumn())
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("", total=None)

        def show(now: ReproductionProgress) -> None:
            total_s = None if math.isnan(now.total_s) else now.total_s
            progress.update(task, description=now.doing, completed=now.done_s, total=total_s)

        return reproduce(names, seeds=seeds, clock=clock, workers=workers, cell=cell, unqualified=unqualified, progress=show)


def _finish(report: "Report", out: Path, json_file: Path | None) -> None:
    """Write the files, say what they say, and end with the status."""
    from hydrohil.reproduction.junit import junit
    from hydrohil.reproduction.page import page
    from hydrohil.reproduction.report import to_json

    texts = {out / PAGE: page(report), out / JUNIT: junit(report)}
    if json_file is not None:
        texts[json_file] = to_json(report)
    _show(report, out / PAGE)  # before the files, so that a full disk does not hide the verdicts
    for path, text in texts.items():
        with writing(path):
            write_whole(path, text)
    raise typer.Exit(report.exit_status)


def write_whole(path: Path, text: str) -> None:
    """Write all of `text` or nothing, so that `path` never holds half of it. A device or pipe is written to, never replaced."""
    if path.exists() and not path.is_file():
        path.write_text(text, encoding="utf-8")
        return
    part = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def _show(report: Any, page: Path) -> None:
    from rich.table import Table

    from hydrohil.claims.claims import band
    from hydrohil.reproduction import formatting as words
    from hydrohil.reproduction.tally import failures

    table = Table("chapter", "figures", "claims", "hold", "do not")
    for count in (*report.counts, report.total):
        table.add_row(count.title, *(str(number) for number in (count.figures, count.claims, count.hold, count.fail)))
    failed = Table(title="claims that do not hold; the page says why", title_justify="left")
    for column in ("figure", "claim", "stated", "measured", "holds in"):
        failed.add_column(column, overflow="fold")
    for one in failures(report.results):
        row = (one.figure.name, one.tally.claim.statement, band(one.tally.claim), words.briefly(one.tally))
        failed.add_row(*row, f"{one.tally.held} of {one.tally.seeds}" + ("" if one.why else "; unexplained"))
    console.print(table)
    if failed.row_count:
        console.print(failed)
    for result in report.results:
        for reason in (*result.tripped, *result.gaps):
            console.print(f"[red bold]NO VERDICT[/] on {result.figure.name}: {reason}", highlight=False)
    console.print(
        f"{report.total.hold} of {report.total.claims} claims hold; {words.duration(report.duration_s)}; {page}", soft_wrap=True
    )
