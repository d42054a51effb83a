"""`hydrohil up`, `down`, `status`, `estop`, `stop`, `reset`, `recover`: everything about a cell that runs."""

import json
import time
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hydrohil.cli.options import (
    RUNNING_CELL,
    AsJson,
    CellName,
    Hosts,
    Port,
    Router,
    app,
    console,
    fail,
    place_of,
    service_options,
)
from hydrohil.shared.contract.messages import GateState
from hydrohil.shared.contract.topics import SERVICES
from hydrohil.shared.exit_status import EXIT_TRANSPORT, EXIT_TRIPPED, EXIT_USAGE
from hydrohil.shared.transport.endpoints import DEFAULT_PORT

if TYPE_CHECKING:
    from hydrohil.cell.processes import Place

_SAMPLES_S = 0.05  # the supervisor judges an emergency stop by what the next samples say of the gate


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
    from hydrohil.cell import processes as cells

    place = place_of(cell, port, hosts, router)
    if cells.remembered(place):
        raise fail(f"cell {cell!r} is up already: `hydrohil status`, or `hydrohil down` first", EXIT_USAGE)
    began = time.monotonic()
    started = cells.start(place, _here(place), with_parent=False, extra=service_options(permit_ttl_ms, realtime=realtime))
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
    from hydrohil.cell import processes as cells

    place = place_of(cell, port, hosts, router)
    pids = cells.remembered(place)
    if not pids:
        raise fail(f"nothing of cell {cell!r} was started by `hydrohil up`", EXIT_USAGE)
    cells.stop(pids[service] for service in ("controller", "supervisor", "plant", "recorder") if service in pids)
    (place.folder / "cell.json").unlink(missing_ok=True)
    console.print(f"cell {cell!r} is down")


@app.command(rich_help_panel=RUNNING_CELL)
def status(
    cell: CellName = "cell", port: Port = DEFAULT_PORT, hosts: Hosts = "", router: Router = "", as_json: AsJson = False
) -> None:
    """Say which services answer, their state, and what was discarded and lost."""
    from rich.table import Column, Table

    from hydrohil.cell import processes as cells

    try:
        with cells.operator_bus(place_of(cell, port, hosts, router)) as bus:
            await_links(bus)
            found = cells.statuses(bus)
    except cells.CellError as error:
        raise fail(error, EXIT_TRANSPORT) from None
    if as_json:
        print(json.dumps(found, indent=2))
    else:
        table = Table("service", Column("state", overflow="fold"), "lost, discarded, counted against a link")
        for service in SERVICES:
            table.add_row(service, _words(service, found.get(service)) + _faults(found.get(service)), _counts(found.get(service)))
        console.print(table)
    if not all(service in found for service in cells.LOOP):
        raise typer.Exit(EXIT_TRANSPORT)
    if found["supervisor"]["mode"] == "TRIPPED":
        raise typer.Exit(EXIT_TRIPPED)


@app.command(rich_help_panel=RUNNING_CELL)
def estop(cell: CellName = "cell", port: Port = DEFAULT_PORT, hosts: Hosts = "", router: Router = "") -> None:
    """Emergency stop at gate and supervisor; either alone suffices.

    Exit 5 unless the plant reports zero current, and reads it back at the D/A where that is possible.
    """
    from hydrohil.cell import processes as cells
    from hydrohil.cell.emergency import outcome

    try:
        with cells.operator_bus(place_of(cell, port, hosts, router)) as bus:
            await_links(bus)
            at_gate = bus.ask("plant", "estop", {}, 1.0)
            bus.ask("supervisor", "estop", {}, 1.0)
    except cells.CellError as error:
        raise fail(f"NOT CONFIRMED: {error}", EXIT_TRANSPORT) from None
    confirmed, told = outcome(at_gate)
    if not confirmed:
        raise fail(told, EXIT_TRANSPORT)
    console.print(told, highlight=False, soft_wrap=True)


@app.command(rich_help_panel=RUNNING_CELL)
def stop(cell: CellName = "cell", port: Port = DEFAULT_PORT, hosts: Hosts = "", router: Router = "") -> None:
    """End the trial and disarm."""
    _request(place_of(cell, port, hosts, router), "supervisor", "stop", "disarmed")


@app.command(rich_help_panel=RUNNING_CELL)
def reset(cell: CellName = "cell", port: Port = DEFAULT_PORT, hosts: Hosts = "", router: Router = "") -> None:
    """Leave TRIPPED. Refused while the cause stands; never moves anything."""
    from hydrohil.cell import processes as cells

    try:
        with cells.operator_bus(place_of(cell, port, hosts, router)) as bus:
            await_links(bus)
            cells.ask(bus, "plant", "reset")
            time.sleep(_SAMPLES_S)
            cells.ask(bus, "supervisor", "reset")
    except cells.CellError as error:
        raise fail(error, EXIT_TRIPPED if isinstance(error, cells.RefusedError) else EXIT_TRANSPORT) from None
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
    from hydrohil.cell import processes as cells

    try:
        with cells.operator_bus(place_of(cell, port, hosts, router)) as bus:
            await_links(bus)
            until = time.monotonic() + seconds
            try:
                while time.monotonic() < until:
                    cells.ask(bus, "supervisor", "recover", 1.0)
                    time.sleep(0.1)
            finally:
                bus.ask("supervisor", "release", {}, 1.0)
            found = cells.statuses(bus, ("supervisor",))
    except cells.CellError as error:
        raise fail(error, EXIT_TRIPPED if isinstance(error, cells.RefusedError) else EXIT_TRANSPORT) from None
    except KeyboardInterrupt:
        raise fail("released", 130) from None
    console.print(f"released: {found.get('supervisor', {}).get('words', '')}; then `hydrohil reset`")


def _request(place: "Place", service: str, verb: str, done: str) -> None:
    from hydrohil.cell import processes as cells

    try:
        with cells.operator_bus(place) as bus:
            await_links(bus)
            cells.ask(bus, service, verb)
    except cells.CellError as error:
        raise fail(error, EXIT_TRANSPORT) from None
    console.print(done)


def await_links(bus: Any, timeout_s: float = 1.0) -> None:
    """Links come up in the background; wait until the plant is seen or a second has passed."""
    deadline = time.monotonic() + timeout_s
    while time.monotonic() < deadline and "plant" not in bus.alive(0.2):
        time.sleep(0.02)


def _counts(found: dict[str, Any] | None) -> str:
    """What a service did not use of the frames that came, a line a topic."""
    received: dict[str, dict[str, int]] = (found or {}).get("link_stats", {})
    lines = []
    for topic, counts in received.items():
        named = [f"{count} {name.replace('_', ' ')}" for name, count in counts.items() if name != "accepted"]
        lines += [f"{topic}: {', '.join(named)}"] * bool(named)
    return "\n".join(lines)


def _faults(found: dict[str, Any] | None) -> str:
    """What is broken on purpose, a line each."""
    from hydrohil.cell.injection import words

    told: dict[str, list[dict[str, Any]]] = (found or {}).get("faults", {})
    return "".join(f"\n[yellow]fault {state}: {words(fault)}[/]" for state, faults in told.items() for fault in faults)


def _words(service: str, found: dict[str, Any] | None) -> str:
    if found is None:
        return "[red]does not answer[/]"
    from hydrohil.cell.emergency import drives

    if service == "supervisor":
        lines = [
            f"{found['mode']}  {found['words']}",
            found.get("qualified", ""),
            *(f"[yellow]{line}[/]" for line in found["warnings"]),
        ]
        return "\n".join(lines)
    if service == "plant":
        gate = "open" if found["gate"] == GateState.OPEN else f"shut: {found['gate_cause']}"
        driven = found.get("dac_readback") or found["dac_counts"]
        held = f"\n[red]the gate has let other codes through, but {drives(driven)}[/]" if driven != found["dac_counts"] else ""
        return f"sample {found['number']}, gate {gate}, lease {found['lease_ms']} ms{held}"
    if service == "controller":
        changed = [f"[yellow]changed: {line}[/]" for line in found.get("changed", ())]
        return "\n".join([f"law {found['law']}, {found['answered']} samples answered", *changed])
    recording = str(found.get("recording", {}).get("path") or "no recording open")
    trip = found.get("trip") or {}
    where = trip.get("path") or (f"[yellow]no file: {trip.get('failure')}[/]" if trip.get("failure") else "being written")
    return recording + (f"\nlast trip {trip['utc']}: {trip['cause']}, {where}" if trip else "")
