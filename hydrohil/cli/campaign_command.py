"""`hydrohil campaign`: thousands of trials of one experiment, into one table."""

import json
import os
import shlex
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrohil.cli.options import app, console, fail, make_folders, writing
from hydrohil.shared.exit_status import EXIT_TRANSPORT, EXIT_USAGE

if TYPE_CHECKING:
    import pyarrow as pa

    from hydrohil.campaign.campaign import Plan
    from hydrohil.campaign.store import Store
    from hydrohil.experiment.experiment import Experiment

_RUNS = Path("runs/campaigns")
_INTERRUPTED = 130


@app.command()
def campaign(
    which: Annotated[str | None, typer.Argument(metavar="[NAME]", help="A campaign that ships, or a TOML file.")] = None,
    listed: Annotated[bool, typer.Option("--list", help="List the campaigns that ship.")] = False,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes on this machine; default: one a core.")] = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler, such as tcp://host:8786.")] = None,
    out: Annotated[Path | None, typer.Option(help=f"Folder of table and pictures; default: {_RUNS}/NAME.")] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Start anew: forget what is finished.")] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Show what would run, and about how long.")] = False,
    trial: Annotated[int | None, typer.Option(help="Show this trial's parameters, and the command that runs it alone.")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write a summary.")] = None,
) -> None:
    """Sweep parameters of an experiment on the local clock, on every core or on a Dask cluster: one Parquet file, a row a trial.

    Killed at any time, the same command goes on where it was. Trips and failed claims are results.
    Exit status: 0 done, 2 usage, 5 the cluster was lost, 130 interrupted.

    Examples: `hydrohil campaign --list`, `hydrohil campaign stability-map --dry-run`,
    `hydrohil campaign mine.toml --scheduler tcp://host:8786`
    """
    from hydrohil.campaign.cluster import ClusterError
    from hydrohil.campaign.reading import find_campaign
    from hydrohil.campaign.store import StoreError
    from hydrohil.experiment.errors import ExperimentError

    _fits_together(listed, dry_run, trial, {"--json": json_file, "--fresh": fresh, "--scheduler": scheduler}, workers)
    if listed:
        return _list()
    if which is None:
        raise fail("which campaign? give the name of one that ships (`hydrohil campaign --list`) or a TOML file", EXIT_USAGE)
    try:
        plan = find_campaign(which)
        if trial is not None:
            return _show_trial(plan, trial)
        longest = _validated(plan)
        processes = workers or len(os.sched_getaffinity(0))
        if dry_run:
            return _describe(plan, longest, processes)
        folder = out or _RUNS / plan.campaign.name
        make_folders(folder / "any", json_file)
        _carry_out(plan, longest, folder, processes, scheduler, fresh, json_file)
    except (ExperimentError, StoreError) as error:
        raise fail(error, EXIT_USAGE) from None
    except ClusterError as error:
        raise fail(error, EXIT_TRANSPORT) from None
    except KeyboardInterrupt:
        raise fail("interrupted: what is finished is kept, and the same command goes on", _INTERRUPTED) from None


def _fits_together(listed: bool, dry_run: bool, trial: int | None, given: dict[str, object], workers: int | None) -> None:
    """Refuse options that would be ignored."""
    shows = [flag for flag, there in (("--list", listed), ("--dry-run", dry_run), ("--trial", trial is not None)) if there]
    unused = [flag for flag, value in given.items() if value]
    if len(shows) > 1 or (shows and unused):
        raise fail(f"{shows[0]} runs nothing: leave {' and '.join((*shows[1:], *unused))} out", EXIT_USAGE)
    if workers and given["--scheduler"]:
        raise fail("--workers is of processes on this machine: leave it out, the cluster has its own", EXIT_USAGE)


def _list() -> None:
    from rich.table import Table

    from hydrohil.campaign.reading import read, shipped
    from hydrohil.campaign.trials import count

    table = Table("name", "trials", "experiment", "title")
    for name, path in shipped().items():
        plan = read(path)
        table.add_row(name, str(count(plan.campaign)), plan.campaign.experiment, plan.campaign.title)
    console.print(table)


def _show_trial(plan: "Plan", number: int) -> None:
    from hydrohil.campaign.trials import command, count, trial_of

    if not 0 <= number < count(plan.campaign):
        raise fail(f"--trial is {number}: {plan.campaign.name} has trials 0 to {count(plan.campaign) - 1}", EXIT_USAGE)
    made = trial_of(plan.campaign, number)
    told = "".join(f"\n  {name} = {value}" for name, value in made.parameters.items())
    words = f"trial {number}: point {made.point}, repeat {made.repeat}, seed {made.seed}{told}"
    console.print(words, highlight=False, markup=False)
    print(command(plan, made))


def _validated(plan: "Plan") -> "Experiment":
    """The longest of the trials that were validated; raises ExperimentError."""
    from hydrohil.campaign.trials import validate

    return validate(plan)


def _describe(plan: "Plan", longest: "Experiment", workers: int) -> None:
    """What would run."""
    from rich.table import Table

    from hydrohil.campaign.axis import KINDS
    from hydrohil.campaign.run import TIMES_REAL_TIME, trial_s
    from hydrohil.campaign.trials import count, points
    from hydrohil.reproduction.formatting import duration

    one = plan.campaign
    table = Table("parameter", "swept over", "sets")
    for name, axis in one.sweep.items():
        kind = next(kind for kind in KINDS if getattr(axis, kind) is not None)
        table.add_row(name, f"{kind} {_brief(getattr(axis, kind))}", ", ".join(f"{p} = {f}" for p, f in axis.sets.items()))
    console.print(f"[bold]{one.name}[/]: {one.title}; of {one.experiment}, {longest.duration_s:g} s a trial", highlight=False)
    console.print(table)
    trials, measured = count(one), ", ".join([*one.metrics, *(["the experiment's claims"] if one.claims else [])])
    console.print(f"{trials} trials: {points(one)} points, {one.repeats} of each; measured: {measured}", highlight=False)
    takes = duration(trials * trial_s(longest) / workers)
    console.print(f"about {takes} on {workers} workers, if each runs {TIMES_REAL_TIME:g} times real time", highlight=False)


def _brief(swept: Any) -> str:
    if not hasattr(swept, "_asdict"):
        return ", ".join(map(str, swept))
    return ", ".join(f"{name.rstrip('_')} {value}" for name, value in swept._asdict().items() if value is not None)


def _carry_out(
    plan: "Plan",
    longest: "Experiment",
    folder: Path,
    workers: int,
    scheduler: str | None,
    fresh: bool,
    json_file: Path | None,
) -> None:
    """Run what is missing, then the table, the pictures, the summary."""
    from hydrohil.campaign.pictures import draw_all
    from hydrohil.campaign.store import opened

    began = time.perf_counter()
    with opened(plan, folder, fresh=fresh) as store:
        table = store.finished()
        ran = 0
        if table is None:
            ran = _run(store, longest, workers, scheduler)
            table = store.finish()
        wall_s = time.perf_counter() - began
        try:
            drawn = draw_all(plan, table, folder)
        except OSError as reason:
            why = reason.strerror or reason
            raise fail(f"{folder}: a picture cannot be written ({why}): the table is whole; make room", EXIT_USAGE) from None
        _finish(plan, table, store.final, drawn, ran, wall_s, json_file)


def _run(store: "Store", longest: "Experiment", workers: int, scheduler: str | None) -> int:
    """Run the trials that no part has, with a bar; returns how many there were."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    from hydrohil.campaign.cluster import cluster
    from hydrohil.campaign.run import pending, run, trial_s
    from hydrohil.campaign.trials import count
    from hydrohil.campaign.work import COMPLETED

    todo, all_of_them = pending(store), count(store.plan.campaign)
    bar = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn(True))
    done, ended_early = all_of_them - len(todo), 0
    if done:
        console.print(f"goes on: {done} of {all_of_them} trials are finished", highlight=False)
    if not todo:
        return 0
    try:
        with Progress(*bar, console=console, refresh_per_second=2, speed_estimate_period=120.0) as progress:
            task = progress.add_task("starting; compiles once after a change", total=all_of_them, completed=done)
            with cluster(min(workers, len(todo)), scheduler) as client:
                began = time.perf_counter()

                def tell(rows: list[dict[str, Any]]) -> None:
                    nonlocal done, ended_early
                    done += len(rows)
                    ended_early += sum(row["ended"] != COMPLETED for row in rows)
                    rate = (done - all_of_them + len(todo)) / (time.perf_counter() - began)
                    words = f"{rate:.3g} trials/s" + (f", {ended_early} did not complete" if ended_early else "")
                    progress.update(task, completed=done, description=words)

                run(client, store, todo, trial_s(longest), tell)
    except KeyboardInterrupt:
        again = shlex.join(["hydrohil", *sys.argv[1:]]).replace(" --fresh", "")
        words = f"interrupted: {done} of {all_of_them} trials are kept in {store.parts}; go on with: {again}"
        raise fail(words, _INTERRUPTED) from None
    return len(todo)


def _finish(
    plan: "Plan", table: "pa.Table", final: Path, drawn: list[Path], ran: int, wall_s: float, json_file: Path | None
) -> None:
    """Say what came of it, and write it down."""
    from hydrohil.campaign import summary
    from hydrohil.campaign.table import known_identity

    found = {
        "name": plan.campaign.name,
        **known_identity(table.schema),
        "table": str(final),
        "pictures": [str(path) for path in drawn],
        "ran_now": ran,
        "wall_s": wall_s,
        "trials_per_s": ran / wall_s,
        "ended": summary.ended(table),
        "causes": summary.causes(table),
        "metrics": summary.metrics(plan, table),
        "claims": summary.claims(plan, table),
    }
    _show(found)
    if json_file is not None:
        with writing(json_file):
            json_file.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")


def _show(found: dict[str, Any]) -> None:
    from rich.table import Table

    if found["metrics"]:
        table = Table("metric", "of", "trials", "least", "5 %", "median", "95 %", "most", "not determined")
        for one in found["metrics"]:
            spread = ("-" if one[k] is None else f"{one[k]:.4g}" for k in ("least", "p5", "median", "p95", "most"))
            unit = "" if one["unit"] == "1" else f", {one['unit']}"
            table.add_row(f"{one['metric']}{unit}", one["of"], str(one["trials"]), *spread, str(one["not_determined"]))
        console.print(table)
    if found["claims"]:
        table = Table("claim", "stated", "of", "holds in")
        for one in found["claims"]:
            table.add_row(one["statement"], one["stated"], one["of"], f"{one['hold']} of {one['trials']}")
        console.print(table)
    for words, number in found["causes"].items():
        console.print(f"did not complete: {number} by {words}", highlight=False, markup=False)
    told = ", ".join(f"{number} {words}" for words, number in found["ended"].items() if number)
    speed = f"; {found['ran_now']} now, {found['trials_per_s']:.3g} a second" if found["ran_now"] else "; nothing was left to run"
    console.print(f"{told}{speed}", highlight=False)
    for path in (found["table"], *found["pictures"]):
        console.print(path, highlight=False, soft_wrap=True)
