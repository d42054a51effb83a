"""`hydrohil up`, `down`, `status`, `estop`, `stop`, `reset`, `recover`: everything about a cell that runs."""

import json
import time
from typing import TYPE_CHECKING, Annotated

import typer

from hydrohil.cli.options import (
    RUNNING_CELL,
    AsJson,
    CellName,
    Hosts,
    Port,
    Router,
    app,
    attached,
    console,
    fail,
    failing,
    place_of,
)
from hydrohil.shared.contract.topics import SERVICES
from hydrohil.shared.exit_status import EXIT_TRANSPORT, EXIT_TRIPPED, EXIT_USAGE
from hydrohil.shared.transport.endpoints import DEFAULT_PORT

if TYPE_CHECKING:
    from hydrohil.cell.processes import Place


@app.command(rich_help_panel=RUNNING_CELL)
def up(
    cell: CellName = "cell",
    port: Port = DEFAULT_PORT,
    hosts: Hosts = "",
    router: Router = "",
    permit_ttl_ms: Annotated[float | None, typer.Option(help="Lease; default: chosen from this host's lateness.")] = None,
    realtime: Annotated[bool, typer.Option(help="Ask for real-time scheduling.")] = True,
) -> None:
    """Start a cell in the background and wait until it is ready. Services that `--hosts` puts elsewhere are started there.

    Example: `hydrohil up && hydrohil run fig-4-25 && hydrohil down`
    """
    from hydrohil.cell.background import bring_up
    from hydrohil.cell.connection import service_options
    from hydrohil.cell.processes import remembered

    place = place_of(cell, port, hosts, router)
    if remembered(place):
        raise fail(f"cell {cell!r} is up already: `hydrohil status`, or `hydrohil down` first", EXIT_USAGE)
    services, options, began = _here(place), service_options(permit_ttl_ms, realtime=realtime), time.monotonic()
    with (
        failing("interrupted: stopped what was started", interrupted_status=EXIT_TRANSPORT),
        console.status("starting: compiles once, then measures this host for two seconds"),
    ):
        found = bring_up(place, services, options)
    lease_ms = found["plant"]["lease_ms"]
    console.print(
        f"cell {cell!r} ready in {time.monotonic() - began:.2f} s; lease {lease_ms:.1f} ms; logs in {place.folder}",
        soft_wrap=True,
    )
    console.print(found["supervisor"]["qualified"], soft_wrap=True, markup=False, highlight=False)


def _here(place: "Place") -> list[str]:
    """Services to start on this machine; says how the others are started."""
    away = place.elsewhere(SERVICES)
    if len(away) == len(SERVICES):
        raise fail("none of this cell's services is on this machine: start each on its host (`hydrohil plant`)", EXIT_USAGE)
    for service in away:
        line = " ".join(("hydrohil", service, *place.words))
        console.print(f"on {place.network.host(service)}: {line}", soft_wrap=True, highlight=False, markup=False)
    return [service for service in SERVICES if service not in away]


@app.command(rich_help_panel=RUNNING_CELL)
def down(cell: CellName = "cell", port: Port = DEFAULT_PORT, hosts: Hosts = "", router: Router = "") -> None:
    """Stop what `up` started on this machine; the valves go to zero first."""
    from hydrohil.cell.background import take_down

    if not take_down(place_of(cell, port, hosts, router)):
        raise fail(f"nothing of cell {cell!r} was started by `hydrohil up`", EXIT_USAGE)
    console.print(f"cell {cell!r} is down")


@app.command(rich_help_panel=RUNNING_CELL)
def status(
    cell: CellName = "cell", port: Port = DEFAULT_PORT, hosts: Hosts = "", router: Router = "", as_json: AsJson = False
) -> None:
    """Say which services answer, their state, and what was discarded and lost."""
    from hydrohil.cell.processes import LOOP
    from hydrohil.cli.status_table import status_table

    with attached(cell, port, hosts, router) as found:
        statuses = found.status()
    if as_json:
        print(json.dumps(statuses, indent=2))
    else:
        console.print(status_table(statuses))
        if not statuses:
            console.print(
                f"cell {cell!r} is not up: `hydrohil up` starts it; `hydrohil trip` shows the newest trip", highlight=False
            )
    if not all(service in statuses for service in LOOP):
        raise typer.Exit(EXIT_TRANSPORT)
    if statuses["supervisor"]["mode"] == "TRIPPED":
        raise typer.Exit(EXIT_TRIPPED)


@app.command(rich_help_panel=RUNNING_CELL)
def estop(cell: CellName = "cell", port: Port = DEFAULT_PORT, hosts: Hosts = "", router: Router = "") -> None:
    """Emergency stop at gate and supervisor; either alone suffices.

    Exit 5 unless the plant reports zero current, and reads it back at the D/A where that is possible.
    """
    from hydrohil.cell.cell import Cell
    from hydrohil.cell.processes import CellError, NotConfirmedError

    with failing():
        try:
            with Cell.attach(cell, port, hosts=hosts, router=router) as found:
                confirmed = found.estop()
        except CellError as error:
            unconfirmed = isinstance(error, NotConfirmedError)
            raise fail(error if unconfirmed else f"NOT CONFIRMED: {error}", EXIT_TRANSPORT) from None
    console.print(confirmed, highlight=False, soft_wrap=True)


@app.command(rich_help_panel=RUNNING_CELL)
def stop(cell: CellName = "cell", port: Port = DEFAULT_PORT, hosts: Hosts = "", router: Router = "") -> None:
    """End the trial and disarm."""
    with attached(cell, port, hosts, router) as found:
        found.stop()
    console.print("disarmed")


@app.command(rich_help_panel=RUNNING_CELL)
def reset(cell: CellName = "cell", port: Port = DEFAULT_PORT, hosts: Hosts = "", router: Router = "") -> None:
    """Leave TRIPPED. Refused while the cause stands; never moves anything."""
    with attached(cell, port, hosts, router, refused=EXIT_TRIPPED) as found:
        found.reset()
    console.print("reset: disarmed")


@app.command(rich_help_panel=RUNNING_CELL)
def recover(
    seconds: Annotated[float, typer.Option(min=0.1, max=30.0, help="Hold for this long; Ctrl-C releases.")] = 2.0,
    cell: CellName = "cell",
    port: Port = DEFAULT_PORT,
    hosts: Hosts = "",
    router: Router = "",
) -> None:
    """Hold to run: move slowly in the direction that unloads what tripped, as long as this command runs."""
    with attached(cell, port, hosts, router, interrupted="released", refused=EXIT_TRIPPED) as found:
        words = found.recover(seconds)
    console.print(f"released: {words}; then `hydrohil reset`")
