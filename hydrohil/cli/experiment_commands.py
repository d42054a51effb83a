"""`hydrohil list`, `show`, `run`, `view`: everything about experiments and what they leave."""

import importlib.util
import json
import os
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from hydrohil.cli.options import (
    EXPERIMENTS,
    AsJson,
    CellName,
    Hosts,
    Injected,
    Port,
    Router,
    Settings,
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

_RUNS = Path("runs")


@app.command("list", rich_help_panel=EXPERIMENTS)
def list_experiments(
    words: Annotated[list[str] | None, typer.Argument(metavar="[FILTER]...", help="Those whose line has every word.")] = None,
    as_json: AsJson = False,
) -> None:
    """List the experiments that ship, and the figures that are computed.

    Examples: `hydrohil list`, `hydrohil list sine`, `hydrohil list plate force --json`
    """
    from rich.table import Table

    from hydrohil.reproduction.plan import figures

    found = [figure for figure in figures() if figure.has(words or ())]
    if as_json:
        print(json.dumps([figure.summary() for figure in found], indent=2))
        return
    if not found:
        raise fail(f"no experiment has {' and '.join(map(repr, words or ()))} in its line: `hydrohil list` shows all", EXIT_USAGE)
    table = Table("name", "alias", "title", "claims")
    for figure in found:
        claims = "computed" if figure.computed else str(figure.summary()["claims"])
        table.add_row(", ".join((figure.name, *figure.also)), figure.subject.alias, figure.subject.title, claims)
    console.print(table)


@app.command(rich_help_panel=EXPERIMENTS)
def show(
    name: Annotated[str, typer.Argument(help="Name, alias, or a TOML file.")],
    toml: Annotated[bool, typer.Option("--toml", help="Print the whole experiment, every default spelled out.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the same as JSON.")] = False,
    as_schema: Annotated[bool, typer.Option("--schema", help="Print the JSON Schema of what --json prints.")] = False,
    settings: Settings = None,
) -> None:
    """Show an experiment; `--toml` prints a file that runs, with the unit and the bounds of each value.

    Examples: `hydrohil show fig-4-25`, `hydrohil show fig-4-25 --toml > mine.toml; hydrohil run mine.toml`,
    `hydrohil show fig-5-5 --json`, `hydrohil show fig-5-5 --schema`
    """
    from rich.markup import escape

    from hydrohil.claims.claims import band
    from hydrohil.experiment.commented import commented_toml
    from hydrohil.experiment.experiment import to_plain, warnings
    from hydrohil.experiment.json_schema import experiment_schema

    if toml + as_json + as_schema > 1:
        raise fail("--toml, --json and --schema exclude each other: give one", EXIT_USAGE)
    experiment = experiment_of(name, settings)
    if toml:
        sys.stdout.write(commented_toml(experiment))
        return
    if as_json or as_schema:
        print(json.dumps(experiment_schema() if as_schema else to_plain(experiment), indent=2))
        return
    title, source = escape(experiment.title), escape(experiment.source)
    console.print(f"[bold]{experiment.name}[/] ({experiment.alias}): {title}\n{source}", highlight=False)
    console.print(f"{experiment.duration_s:g} s, law {experiment.controller.law}, target {experiment.controller.target}")
    for line in warnings(experiment):
        console.print(f"[yellow]warning[/]: {escape(line)}", highlight=False, soft_wrap=True)
    for claim in experiment.claims:
        console.print(f"  {claim.statement}: {claim.metric} of {claim.channel} {band(claim)}  [{claim.source}]", markup=False)


@app.command(rich_help_panel=EXPERIMENTS)
def run(
    name: Annotated[str, typer.Argument(help="Name, alias, or a TOML file.")],
    clock: Annotated[str, typer.Option(help="real, lockstep or local.")] = "real",
    settings: Settings = None,
    injected: Injected = None,
    seed: Annotated[int, typer.Option(min=0, help="Of noise, jitter and faults.")] = 0,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write the report.")] = None,
    trace_file: Annotated[Path | None, typer.Option("--trace", help="Write every sample (.npz, .csv or .parquet).")] = None,
    rrd: Annotated[Path | None, typer.Option(help="Write a Rerun recording.")] = None,
    cell: CellName = "cell",
    port: Port = DEFAULT_PORT,
    hosts: Hosts = "",
    router: Router = "",
    permit_ttl_ms: Annotated[float | None, typer.Option(help="Lease of a cell brought up for this run.")] = None,
    realtime: Annotated[bool, typer.Option(help="Real-time scheduling of a cell brought up for this run.")] = True,
    unqualified: Unqualified = False,
) -> None:
    """Run an experiment and judge its claims.

    Exit status: 0 all claims hold, 1 a claim fails, 2 usage, 3 the rig tripped, 5 transport.

    Examples: `hydrohil run fig-4-25 --clock local`, `hydrohil run fig-5-5 --rrd runs/static.rrd --seed 3`,
    `hydrohil run fig-5-5 --inject "stuck force at=1.0 for=0.5" --inject "drop supply value=0.5 at=2"`
    """
    from hydrohil.cell.cell import Cell
    from hydrohil.claims.trace_files import format_of
    from hydrohil.cli import report as reports
    from hydrohil.cli import run as runs

    if clock not in ("real", "lockstep", "local"):
        raise fail(f"--clock is {clock!r}: expected real, lockstep or local", EXIT_USAGE)
    if clock == "local" and rrd is not None:
        raise fail("--rrd needs a cell with a recorder: use --clock lockstep or real (--trace works on every clock)", EXIT_USAGE)
    make_folders(json_file, trace_file, rrd)
    if trace_file is not None:
        with failing():
            format_of(trace_file)
    experiment = experiment_of(name, settings, injected)
    with failing("interrupted: valves at zero, disarmed"):
        if clock == "local":
            found = runs.run_local(experiment, seed, console)
        else:

            def open_cell() -> Cell:
                return Cell.open(cell, port, hosts=hosts, router=router, lease_ms=permit_ttl_ms, realtime=realtime)

            found = runs.run_live(
                open_cell, experiment, seed, "lockstep" if clock == "lockstep" else "real", rrd, console, unqualified=unqualified
            )
    found = runs.kept(found, trace_file)
    reports.show(console, found)
    if json_file is not None:
        with writing(json_file):
            json_file.write_text(json.dumps(found.report(), indent=2) + "\n")
    raise typer.Exit(found.exit_status)


@app.command(rich_help_panel=EXPERIMENTS)
def view(recording: Annotated[Path | None, typer.Argument(help="A .rrd file; default: the newest in runs/.")] = None) -> None:
    """Open a recording in the Rerun viewer, all files of a long one together."""
    from hydrohil.shared.contract.file_parts import parts_of

    chosen = recording or max(_RUNS.glob("*.rrd"), key=lambda path: path.stat().st_mtime, default=None)
    if chosen is None or not chosen.exists():
        raise fail(f"no recording at {chosen or _RUNS}: run an experiment with --rrd FILE first", EXIT_USAGE)
    if not chosen.is_file() or not os.access(chosen, os.R_OK):
        raise fail(f"{chosen}: cannot be read: give the path of a .rrd file", EXIT_USAGE)
    package = importlib.util.find_spec("rerun_cli")
    if package is None or package.origin is None:
        raise fail("the Rerun viewer is not installed: `make install`", EXIT_USAGE)
    viewer = Path(package.origin).with_name("rerun")  # not the script of that name, which leaves the viewer behind at a signal
    os.execv(viewer, [str(viewer), *map(str, parts_of(chosen))])


def experiment_of(name: str, settings: list[str] | None, injected: list[str] | None = None) -> Any:
    """From a file or the library, with `--set` and `--inject` applied; exit 2 with one line a problem."""
    from hydrohil.experiment.errors import ExperimentError
    from hydrohil.experiment.overrides import with_overrides
    from hydrohil.thesis.library import load

    try:
        return with_overrides(load(name), settings or []).with_faults(*(injected or ()), where="--inject")
    except ExperimentError as error:
        raise fail(_computed(name) or error, EXIT_USAGE) from None


def _computed(name: str) -> str:
    """What to say of a figure that is no trial; "" of anything else."""
    from hydrohil.reproduction.plan import figures

    computed = {alias for figure in figures() if figure.computed for alias in figure.names}
    return f"{name} is a computed figure, no trial: `hydrohil reproduce --only {name}` shows it" if name in computed else ""
