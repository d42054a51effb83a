"""`hydrohil`: every command of the rig. Each imports what it needs, so that a service starts fast."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from shared.bus import DEFAULT_PORT
from shared.messages import GateState
from shared.process import EXIT_TRANSPORT, EXIT_TRIPPED, EXIT_USAGE
from shared.topics import SERVICES

app = typer.Typer(
    help="Distributed hardware-in-the-loop rig for force-controlled hydraulic manipulators.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)
console = Console(width=None if sys.stdout.isatty() else 120)
errors = Console(stderr=True, highlight=False, soft_wrap=True)

CellName = Annotated[str, typer.Option("--cell", help="Name of the cell.")]
Port = Annotated[int, typer.Option("--port", help="First of the cell's four ports.", min=1024, max=65000)]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]
_PASS_ON = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}
_RUNS = Path("runs")


def fail(message: object, status: int) -> typer.Exit:
    """One line on stderr; raise what is returned."""
    errors.print(str(message), style="red")
    return typer.Exit(status)


@app.command(context_settings=_PASS_ON)
def plant(context: typer.Context) -> None:
    """Run the plant (emulator and gate) in the foreground; `hydrohil plant --help` lists its options."""
    from services.plant.main import main as run_plant

    raise typer.Exit(run_plant(context.args))


@app.command(context_settings=_PASS_ON)
def controller(context: typer.Context) -> None:
    """Run the controller in the foreground."""
    from services.controller.service import main as run_controller

    raise typer.Exit(run_controller(context.args))


@app.command(context_settings=_PASS_ON)
def supervisor(context: typer.Context) -> None:
    """Run the supervisor in the foreground."""
    from services.supervisor.service import main as run_supervisor

    raise typer.Exit(run_supervisor(context.args))


@app.command(context_settings=_PASS_ON)
def recorder(context: typer.Context) -> None:
    """Run the recorder in the foreground."""
    from services.recorder.service import main as run_recorder

    raise typer.Exit(run_recorder(context.args))


@app.command()
def up(
    cell: CellName = "cell",
    port: Port = DEFAULT_PORT,
    permit_ttl_ms: Annotated[float | None, typer.Option(help="Lease; default: chosen from this host's lateness.")] = None,
    realtime: Annotated[bool, typer.Option(help="Ask for real-time scheduling.")] = True,
) -> None:
    """Start a cell in the background and wait until it is ready.

    Example: `hydrohil up && hydrohil run fig-4-25 && hydrohil down`
    """
    from services.operator import cell as cells

    place = cells.Place(cell, port)
    if cells.remembered(place):
        raise fail(f"cell {cell!r} is up already: `hydrohil status`, or `hydrohil down` first", EXIT_USAGE)
    began = time.monotonic()
    started = cells.start(place, SERVICES, with_parent=False, extra=_extra(permit_ttl_ms, realtime=realtime))
    cells.remember(place, started)
    try:
        with console.status("starting: compiles once, then measures this host for two seconds"), cells.operator_bus(place) as bus:
            found = cells.await_ready(place, bus, started)
    except (cells.CellError, KeyboardInterrupt) as error:
        cells.stop(process.pid for process in started.values())
        raise fail(str(error) or "interrupted: stopped what was started", EXIT_TRANSPORT) from None
    lease_ms = found["plant"]["lease_ms"]
    console.print(
        f"cell {cell!r} ready in {time.monotonic() - began:.2f} s; lease {lease_ms:.1f} ms; logs in {place.folder}",
        soft_wrap=True,
    )


@app.command()
def down(cell: CellName = "cell", port: Port = DEFAULT_PORT) -> None:
    """Stop what `up` started; the valves go to zero first."""
    from services.operator import cell as cells

    place = cells.Place(cell, port)
    pids = cells.remembered(place)
    if not pids:
        raise fail(f"nothing of cell {cell!r} was started by `hydrohil up`", EXIT_USAGE)
    cells.stop(pids[service] for service in ("controller", "supervisor", "plant", "recorder") if service in pids)
    (place.folder / "cell.json").unlink(missing_ok=True)
    console.print(f"cell {cell!r} is down")


@app.command()
def status(cell: CellName = "cell", port: Port = DEFAULT_PORT, as_json: AsJson = False) -> None:
    """Say which services answer, their state, and what was discarded and lost."""
    from rich.table import Table

    from services.operator import cell as cells

    try:
        with cells.operator_bus(cells.Place(cell, port)) as bus:
            _await_links(bus)
            found = cells.statuses(bus)
    except cells.CellError as error:
        raise fail(error, EXIT_TRANSPORT) from None
    if as_json:
        print(json.dumps(found, indent=2))
    else:
        table = Table("service", "state")
        for service in SERVICES:
            table.add_row(service, _words(service, found.get(service)))
        console.print(table)
    if not all(service in found for service in cells.LOOP):
        raise typer.Exit(EXIT_TRANSPORT)
    if found["supervisor"]["mode"] == "TRIPPED":
        raise typer.Exit(EXIT_TRIPPED)


@app.command("list")
def list_experiments(as_json: AsJson = False) -> None:
    """List the experiments that ship."""
    from rich.table import Table

    from experiments.library import catalogue

    if as_json:
        print(
            json.dumps(
                [{"name": e.name, "alias": e.alias, "title": e.title, "claims": len(e.claims)} for e in catalogue()], indent=2
            )
        )
        return
    table = Table("name", "alias", "title", "claims")
    for experiment in catalogue():
        table.add_row(experiment.name, experiment.alias, experiment.title, str(len(experiment.claims)))
    console.print(table)


@app.command()
def show(
    name: Annotated[str, typer.Argument(help="Name, alias, or a TOML file.")],
    toml: Annotated[bool, typer.Option("--toml", help="Print the whole experiment, every default spelled out.")] = False,
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="PATH=VALUE", help="Change one value.")] = None,
) -> None:
    """Show an experiment; `--toml` prints a file that runs.

    Example: `hydrohil show fig-4-25 --toml > mine.toml; hydrohil run mine.toml`
    """
    from experiments.claims import band
    from experiments.experiment import to_toml

    experiment = _experiment(name, settings)
    if toml:
        sys.stdout.write(to_toml(experiment))
        return
    console.print(f"[bold]{experiment.name}[/] ({experiment.alias}): {experiment.title}\n{experiment.source}", highlight=False)
    console.print(f"{experiment.duration_s:g} s, law {experiment.controller.law}, target {experiment.controller.target}")
    for claim in experiment.claims:
        console.print(f"  {claim.statement}: {claim.metric} of {claim.channel} {band(claim)}  [{claim.source}]", markup=False)


@app.command()
def run(
    name: Annotated[str, typer.Argument(help="Name, alias, or a TOML file.")],
    clock: Annotated[str, typer.Option(help="real, lockstep or local.")] = "real",
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="PATH=VALUE", help="Change one value.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of noise and jitter.")] = 0,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write the report.")] = None,
    trace_file: Annotated[Path | None, typer.Option("--trace", help="Write every sample (.npz).")] = None,
    rrd: Annotated[Path | None, typer.Option(help="Write a Rerun recording.")] = None,
    cell: CellName = "cell",
    port: Port = DEFAULT_PORT,
    permit_ttl_ms: Annotated[float | None, typer.Option(help="Lease of a cell brought up for this run.")] = None,
    realtime: Annotated[bool, typer.Option(help="Real-time scheduling of a cell brought up for this run.")] = True,
) -> None:
    """Run an experiment and judge its claims.

    Exit status: 0 all claims hold, 1 a claim fails, 2 usage, 3 the rig tripped, 5 transport.

    Examples: `hydrohil run fig-4-25 --clock local`, `hydrohil run fig-5-5 --rrd runs/static.rrd --seed 3`
    """
    from services.operator import cell as cells
    from services.operator import report as reports
    from services.operator.run import Wanted, run_experiment

    if clock not in ("real", "lockstep", "local"):
        raise fail(f"--clock is {clock!r}: expected real, lockstep or local", EXIT_USAGE)
    if clock == "local" and rrd is not None:
        raise fail("--rrd needs a cell with a recorder: use --clock lockstep or real (--trace works on every clock)", EXIT_USAGE)
    for path in (json_file, trace_file, rrd):
        if path is not None:
            path.parent.mkdir(parents=True, exist_ok=True)
    experiment = _experiment(name, settings)
    place = cells.Place(cell, port)
    wanted = Wanted(experiment, clock, seed, rrd, trace_file, _extra(permit_ttl_ms, realtime=realtime))
    try:
        report = run_experiment(place, wanted, console)
    except cells.TrippedError as error:
        raise fail(error, EXIT_TRIPPED) from None
    except cells.CellError as error:
        raise fail(error, EXIT_TRANSPORT) from None
    except KeyboardInterrupt:
        raise fail("interrupted: valves at zero, disarmed", 130) from None
    reports.show(console, report)
    if json_file is not None:
        reports.write_json(json_file, report)
    raise typer.Exit(report.exit_status)


@app.command()
def estop(cell: CellName = "cell", port: Port = DEFAULT_PORT) -> None:
    """Emergency stop at gate and supervisor; either alone suffices. Exit 5 unless the plant reports zero current."""
    from services.operator import cell as cells

    try:
        with cells.operator_bus(cells.Place(cell, port)) as bus:
            _await_links(bus)
            at_gate = bus.ask("plant", "estop", {}, 1.0)
            bus.ask("supervisor", "estop", {}, 1.0)
    except cells.CellError as error:
        raise fail(f"NOT CONFIRMED: {error}", EXIT_TRANSPORT) from None
    if at_gate is None or not at_gate.accepted or json.loads(at_gate.values)["dac_counts"] != [2048, 2048, 2048]:
        raise fail("NOT CONFIRMED: the plant has not reported zero current; cut the hydraulic supply", EXIT_TRANSPORT)
    console.print("stopped: the plant reports zero current; `hydrohil reset` when the cause is gone")


@app.command()
def stop(cell: CellName = "cell", port: Port = DEFAULT_PORT) -> None:
    """End the trial and disarm."""
    _request(cell, port, "supervisor", "stop", "disarmed")


@app.command()
def reset(cell: CellName = "cell", port: Port = DEFAULT_PORT) -> None:
    """Leave TRIPPED. Refused while the cause stands; never moves anything."""
    from services.operator import cell as cells

    try:
        with cells.operator_bus(cells.Place(cell, port)) as bus:
            _await_links(bus)
            cells.ask(bus, "supervisor", "reset")
            cells.ask(bus, "plant", "reset")
    except cells.CellError as error:
        raise fail(error, EXIT_TRIPPED) from None
    console.print("reset: disarmed")


@app.command()
def recover(
    seconds: Annotated[float, typer.Option(min=0.1, max=30.0, help="Hold for this long; Ctrl-C releases.")] = 2.0,
    cell: CellName = "cell",
    port: Port = DEFAULT_PORT,
) -> None:
    """Hold to run: move slowly in the direction that unloads what tripped, as long as this command runs."""
    from services.operator import cell as cells

    try:
        with cells.operator_bus(cells.Place(cell, port)) as bus:
            _await_links(bus)
            until = time.monotonic() + seconds
            try:
                while time.monotonic() < until:
                    cells.ask(bus, "supervisor", "recover", 1.0)
                    time.sleep(0.1)
            finally:
                bus.ask("supervisor", "release", {}, 1.0)
            found = cells.statuses(bus, ("supervisor",))
    except cells.CellError as error:
        raise fail(error, EXIT_TRIPPED) from None
    except KeyboardInterrupt:
        raise fail("released", 130) from None
    console.print(f"released: {found.get('supervisor', {}).get('words', '')}; then `hydrohil reset`")


@app.command()
def view(recording: Annotated[Path | None, typer.Argument(help="A .rrd file; default: the newest in runs/.")] = None) -> None:
    """Open a recording in the Rerun viewer."""
    chosen = recording or max(_RUNS.glob("*.rrd"), key=lambda path: path.stat().st_mtime, default=None)
    if chosen is None or not chosen.exists():
        raise fail(f"no recording at {chosen or _RUNS}: run an experiment with --rrd FILE first", EXIT_USAGE)
    rerun = Path(sys.executable).with_name("rerun")
    raise typer.Exit(subprocess.call([str(rerun), str(chosen)]))


def _extra(permit_ttl_ms: float | None, *, realtime: bool) -> dict[str, list[str]]:
    """Options of each service that `up` and `run` start."""
    common = [] if realtime else ["--no-realtime"]
    lease = [] if permit_ttl_ms is None else ["--permit-ttl-ms", str(permit_ttl_ms)]
    return {"plant": common + lease, "controller": common, "supervisor": common}


def _experiment(name: str, settings: list[str] | None) -> Any:
    """From a file or the library, with `--set` applied; exit 2 with one line a problem."""
    from experiments.errors import ExperimentError
    from experiments.experiment import from_toml
    from experiments.library import find
    from experiments.overrides import with_overrides

    try:
        experiment = from_toml(Path(name)) if name.endswith(".toml") or os.sep in name else find(name)
        return with_overrides(experiment, settings or [])
    except ExperimentError as error:
        raise fail(error, EXIT_USAGE) from None


def _request(cell: str, port: int, service: str, verb: str, done: str) -> None:
    from services.operator import cell as cells

    try:
        with cells.operator_bus(cells.Place(cell, port)) as bus:
            _await_links(bus)
            cells.ask(bus, service, verb)
    except cells.CellError as error:
        raise fail(error, EXIT_TRANSPORT) from None
    console.print(done)


def _await_links(bus: Any, timeout_s: float = 1.0) -> None:
    """Links come up in the background; wait until the plant is seen or a second has passed."""
    deadline = time.monotonic() + timeout_s
    while time.monotonic() < deadline and "plant" not in bus.alive(0.2):
        time.sleep(0.02)


def _words(service: str, found: dict[str, Any] | None) -> str:
    if found is None:
        return "[red]does not answer[/]"
    if service == "supervisor":
        return f"{found['mode']}  {found['words']}"
    if service == "plant":
        gate = "open" if found["gate"] == GateState.OPEN else f"shut: {found['gate_cause']}"
        return f"sample {found['number']}, gate {gate}, lease {found['lease_ms']} ms"
    if service == "controller":
        return f"law {found['law']}, {found['answered']} samples answered"
    return str(found.get("recording", {}).get("path") or "no recording open")


def main() -> None:
    """Entry point."""
    app()


if __name__ == "__main__":
    main()
