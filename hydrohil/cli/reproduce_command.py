"""`hydrohil reproduce`: every figure and every claim again, as a page, a JUnit file and an exit status."""

import os
import time
from contextlib import ExitStack
from datetime import datetime
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
    make_folders,
    place_of,
    service_options,
    writing,
)
from hydrohil.shared.exit_status import EXIT_TRANSPORT, EXIT_TRIPPED, EXIT_USAGE
from hydrohil.shared.transport.endpoints import DEFAULT_PORT

if TYPE_CHECKING:  # the page's libraries load when it is made
    from hydrohil.cell.processes import Place
    from hydrohil.reproduction.jobs import Done, Job
    from hydrohil.reproduction.plan import Figure

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
    from hydrohil.cell import processes as cells
    from hydrohil.experiment.errors import ExperimentError
    from hydrohil.reproduction import plan
    from hydrohil.reproduction.pool import LostWorkerError

    wanted = [*(only or []), *(figures or [])]
    try:
        chosen = plan.choose(wanted)
    except ExperimentError as error:
        raise fail(error, EXIT_USAGE) from None
    _usable(clock, wanted, chosen, seeds)
    make_folders(out / PAGE, out / JUNIT, json_file)
    began, groups = time.perf_counter(), plan.groups(chosen)
    try:
        if clock == "local":
            done = _local(groups, seeds, workers or len(os.sched_getaffinity(0)))
        else:
            options = service_options(permit_ttl_ms, realtime=realtime)
            done = _live(place_of(cell, port, hosts, router), options, groups, seeds, clock, unqualified=unqualified)
    except cells.TrippedError as error:
        raise fail(error, EXIT_TRIPPED) from None
    except cells.UnqualifiedError as error:
        raise fail(error, EXIT_USAGE) from None
    except (cells.CellError, LostWorkerError) as error:
        raise fail(error, EXIT_TRANSPORT) from None
    except KeyboardInterrupt:
        raise fail("interrupted: nothing was written", 130) from None
    command = " ".join(["hydrohil reproduce", *wanted, f"--seeds {seeds} --clock {clock}"])
    _finish(chosen, done, clock, seeds, time.perf_counter() - began, command, out, json_file)


def _usable(clock: str, wanted: list[str], chosen: "tuple[Figure, ...]", seeds: int) -> None:
    """Refuse a clock that does not exist, and a live clock for everything; say how long a live one takes."""
    from hydrohil.reproduction.formatting import duration
    from hydrohil.reproduction.play import simulated_s

    if clock not in ("local", "lockstep", "real"):
        raise fail(f"--clock is {clock!r}: expected local, lockstep or real", EXIT_USAGE)
    if clock == "local":
        return
    from hydrohil.thesis.library import find

    trials = {name for figure in chosen for name in figure.trials}
    takes = duration(seeds * simulated_s([find(name) for name in sorted(trials)]))
    if not wanted:
        raise fail(f"--clock {clock}: {len(trials)} trials take {takes} at real speed: choose some with --only", EXIT_USAGE)
    console.print(f"clock {clock}: {takes} at real speed; trials: {len(trials)}, seeds: {seeds}", highlight=False)


def _local(groups: Any, seeds: int, workers: int) -> "list[Done]":
    """On the local clock, with a bar that knows how long each job takes."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from hydrohil.reproduction.jobs import jobs
    from hydrohil.reproduction.pool import pool

    todo: tuple[Job, ...] = jobs(groups, seeds)
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:.0f} %"), TimeRemainingColumn())
    done = []
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("starting; compiles once after a change", total=None)
        with pool(min(workers, len(todo))) as ready:
            progress.update(task, total=sum(job.cost_s for job in todo), description=f"{len(todo)} jobs")
            for made in ready.run(todo):
                done.append(made)
                progress.update(task, advance=made.job.cost_s, description=made.job.group.figures[0])
        progress.update(task, description="done")
    return done


def _live(
    place: "Place", options: dict[str, list[str]], groups: Any, seeds: int, clock: str, *, unqualified: bool
) -> "list[Done]":
    """In a cell, with a bar that knows how long each trial takes."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from hydrohil.cell.connection import found_or_own_cell
    from hydrohil.cell.processes import LOOP
    from hydrohil.reproduction.live import reproduce_live
    from hydrohil.reproduction.play import simulated_s
    from hydrohil.thesis.library import find

    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with ExitStack() as stack:
        with console.status("waiting for the cell: it measures this host for two seconds"):
            bus = stack.enter_context(found_or_own_cell(place, options, LOOP))
        progress = stack.enter_context(Progress(*columns, console=console))
        total_s = seeds * sum(simulated_s([find(name)]) for group in groups for name in group.trials)
        task, before_s = progress.add_task("", total=total_s), 0.0

        def show(name: str, seed: int) -> None:
            nonlocal before_s
            progress.update(task, description=f"{name}, seed {seed}", advance=before_s)
            before_s = simulated_s([find(name)])

        return reproduce_live(bus, groups, seeds, clock, show, unqualified=unqualified)


def _finish(
    chosen: "tuple[Figure, ...]",
    done: "list[Done]",
    clock: str,
    seeds: int,
    duration_s: float,
    command: str,
    out: Path,
    json_file: Path | None,
) -> None:
    """Write the files, say what they say, and end with the status."""
    from hydrohil.reproduction.junit import junit
    from hydrohil.reproduction.page import page
    from hydrohil.reproduction.report import Report, gathered, machine, times_real_time, to_json
    from hydrohil.shared.compiled.kernel import source_version

    made = datetime.now().astimezone().isoformat(" ", "seconds")
    speed = times_real_time(done)
    report = Report(gathered(chosen, done), clock, seeds, source_version(), made, duration_s, machine(), command, speed)
    texts = {out / PAGE: page(report), out / JUNIT: junit(report)}
    if json_file is not None:
        texts[json_file] = to_json(report)
    _show(report, out / PAGE)  # first: a full disk takes the files, not the verdicts
    for path, text in texts.items():
        with writing(path):
            write_whole(path, text)
    raise typer.Exit(report.exit_status)


def write_whole(path: Path, text: str) -> None:
    """All of `text` or nothing: whoever reads `path` never sees half of it. A device or pipe is written to, never replaced."""
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
        told = (one.figure.name, one.tally.claim.statement, band(one.tally.claim), words.briefly(one.tally))
        failed.add_row(*told, f"{one.tally.held} of {one.tally.seeds}" + ("" if one.why else "; unexplained"))
    console.print(table)
    if failed.row_count:
        console.print(failed)
    for made in report.results:
        for words_ in (*made.tripped, *made.gaps):
            console.print(f"[red bold]NO VERDICT[/] on {made.figure.name}: {words_}", highlight=False)
    console.print(
        f"{report.total.hold} of {report.total.claims} claims hold; {words.duration(report.duration_s)}; {page}", soft_wrap=True
    )
