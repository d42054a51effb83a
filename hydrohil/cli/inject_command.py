"""`hydrohil inject`: break something in a cell that runs, and mend it again."""

import json
from typing import TYPE_CHECKING, Annotated

import typer

from hydrohil.cli.cell_commands import await_links
from hydrohil.cli.options import RUNNING_CELL, AsJson, CellName, Hosts, Port, Router, app, console, fail, place_of
from hydrohil.shared.contract.faults import ROWS, Fault, value_missing
from hydrohil.shared.exit_status import EXIT_TRANSPORT, EXIT_USAGE
from hydrohil.shared.transport.endpoints import DEFAULT_PORT

if TYPE_CHECKING:
    from hydrohil.cell.processes import Place

_USAGE = "expected KIND TARGET, such as `hydrohil inject stuck force --for 2`; `hydrohil inject --list` shows what there is"


@app.command(rich_help_panel=RUNNING_CELL)
def inject(
    kind: Annotated[str | None, typer.Argument(help="What breaks: stuck, offset, leak, ...")] = None,
    target: Annotated[str | None, typer.Argument(help="Where: force, encoder_rotate, valve_out_in, supply, ...")] = None,
    value: Annotated[float | None, typer.Option(help="How much, in the unit that --list names.")] = None,
    lasts_s: Annotated[float, typer.Option("--for", min=0.0, help="Seconds; 0 = until --clear.")] = 0.0,
    after_s: Annotated[float, typer.Option("--after", min=0.0, help="Seconds from the next sample on.")] = 0.0,
    show: Annotated[bool, typer.Option("--list", help="Show every fault with its unit and bounds.")] = False,
    clear: Annotated[bool, typer.Option("--clear", help="End everything that was injected.")] = False,
    as_json: AsJson = False,
    cell: CellName = "cell",
    port: Port = DEFAULT_PORT,
    hosts: Hosts = "",
    router: Router = "",
) -> None:
    """Break something on purpose in a cell that runs, in a trial or outside.

    It begins at the next sample, or later by --after, and lasts over trials until --for is over or --clear ends it.
    Where a trial must break at an exact tick, schedule it: `hydrohil run NAME --inject "stuck force at=1.0 for=0.5"`.

    Examples: `hydrohil inject stuck force --for 2`, `hydrohil inject offset encoder_rotate --value 40 --after 1`,
    `hydrohil inject drop supply --value 0.5`, `hydrohil inject --clear`
    """
    if sum((show, clear, kind is not None)) != 1 or (kind is None) != (target is None):
        raise fail(_USAGE, EXIT_USAGE)
    if show:
        return _list(as_json)
    fault = None if kind is None or target is None else Fault(kind, target, after_s, lasts_s, value or 0.0)
    if fault is not None and value is None and (what := value_missing(fault)):
        raise fail(f"{what}: give --value", EXIT_USAGE)
    done = _ask(fault, place_of(cell, port, hosts, router))
    if as_json:
        print(json.dumps({"fault": None if fault is None else fault._asdict(), "done": done}))
    else:
        console.print(done, highlight=False)


def _ask(fault: Fault | None, place: "Place") -> str:
    """Inject `fault`, or clear all; what was done, in words. Exit 2 where it is refused."""
    from hydrohil.cell import injection
    from hydrohil.cell import processes as cells

    what = "" if fault is None else injection.refused(fault)
    if what:
        raise fail(what, EXIT_USAGE)
    try:
        with cells.operator_bus(place) as bus:
            await_links(bus)
            if fault is None:
                injection.clear(bus)
                return "cleared: nothing injected acts any more"
            return f"{injection.words(fault._asdict())}: {injection.inject(bus, fault)}"
    except cells.RefusedError as error:
        raise fail(error, EXIT_USAGE) from None
    except cells.CellError as error:
        raise fail(error, EXIT_TRANSPORT) from None


def _list(as_json: bool) -> None:
    from rich.table import Table

    from hydrohil.cell import injection

    if as_json:
        print(json.dumps(injection.listed(), indent=2))
        return
    table = Table("kind", "target", "what it does", "value", "clocks")
    for row in ROWS:
        table.add_row(row.kind, ", ".join(row.targets), row.words, injection.bounds(row), ", ".join(row.clocks))
    console.print(table)
