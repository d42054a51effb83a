"""`hydrohil campaign`: thousands of trials of one experiment, into one table."""

import json
import os
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrohil.cli.options import STUDIES, app, console, fail, make_folders, writing
from hydrohil.shared.exit_status import EXIT_TRANSPORT, EXIT_USAGE

if TYPE_CHECKING:
    from hydrohil.campaign.campaign import Plan
    from hydrohil.campaign.run import CampaignProgress

_RUNS = Path("runs/campaigns")
_INTERRUPTED = 130


@app.command(rich_help_panel=STUDIES)
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
        if dry_run:
            return _describe(plan, workers or len(os.sched_getaffinity(0)))
        folder = out or _RUNS / plan.campaign.name
        make_folders(folder / "any", json_file)
        _carry_out(plan, folder, workers, scheduler, fresh, json_file)
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
    trial = trial_of(plan.campaign, number)
    parameters = "".join(f"\n  {name} = {value}" for name, value in trial.parameters.items())
    words = f"trial {number}: point {trial.point}, repeat {trial.repeat}, seed {trial.seed}{parameters}"
    console.print(words, highlight=False, markup=False)
    print(command(plan, trial))


def _describe(plan: "Plan", workers: int) -> None:
    """What would run; raises ExperimentError."""
    from rich.table import Table

    from hydrohil.campaign.axis import KINDS
    from hydrohil.campaign.dispatch import TIMES_REAL_TIME, trial_s
    from hydrohil.campaign.trials import count, points, validate
    from hydrohil.reproduction.formatting import duration

    one, longest = plan.campaign, validate(plan)
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
    plan: "Plan", folder: Path, workers: int | None, scheduler: str | None, fresh: bool, json_file: Path | None
) -> None:
    """Run what is missing, with a bar; then show and write what came of it."""
    from hydrohil.campaign.run import run_campaign

    with _Bar() as bar:
        try:
            result = run_campaign(plan, folder, workers=workers, scheduler=scheduler, fresh=fresh, progress=bar.show)
        except KeyboardInterrupt:
            if bar.last is None:
                raise
            again = shlex.join(["hydrohil", *sys.argv[1:]]).replace(" --fresh", "")
            kept = f"{bar.last.finished} of {bar.last.trials} trials are kept in {folder}"
            raise fail(f"interrupted: {kept}; go on with: {again}", _INTERRUPTED) from None
    found = result.summary()
    _show(found)
    if json_file is not None:
        with writing(json_file):
            json_file.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")


class _Bar:
    """A bar that appears with the first report, unless nothing is left to run."""

    def __init__(self) -> None:
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TimeRemainingColumn(True),
        )
        self._progress = Progress(*columns, console=console, refresh_per_second=2, speed_estimate_period=120.0)
        self._task: Any = None
        self.last: CampaignProgress | None = None

    def __enter__(self) -> "_Bar":
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def show(self, now: "CampaignProgress") -> None:
        """One report of the campaign."""
        first, self.last = self.last is None, now
        if first and now.resumed:
            console.print(f"goes on: {now.resumed} of {now.trials} trials are finished", highlight=False)
        if first and now.finished < now.trials:
            words = "starting; compiles once after a change"
            self._task = self._progress.add_task(words, total=now.trials, completed=now.finished)
            self._progress.start()
        if not first:
            words = f"{now.trials_per_s:.3g} trials/s" + (f", {now.incomplete} did not complete" if now.incomplete else "")
            self._progress.update(self._task, completed=now.finished, description=words)


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
    ended = ", ".join(f"{number} {words}" for words, number in found["ended"].items() if number)
    speed = f"; {found['ran_now']} now, {found['trials_per_s']:.3g} a second" if found["ran_now"] else "; nothing was left to run"
    console.print(f"{ended}{speed}", highlight=False)
    for path in (found["table"], *found["pictures"]):
        console.print(path, highlight=False, soft_wrap=True)
