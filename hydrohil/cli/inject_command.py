"""`hydrohil inject`: break something in a cell that runs, and mend it again."""

import json
from typing import Annotated

import typer

from hydrohil.cli.options import RUNNING_CELL, AsJson, CellName, Hosts, Port, Router, app, attached, console, fail
from hydrohil.shared.contract.faults import ROWS, Fault, value_missing
from hydrohil.shared.exit_status import EXIT_USAGE
from hydrohil.shared.transport.endpoints import DEFAULT_PORT

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
    from hydrohil.cell import injection

    if sum((show, clear, kind is not None)) != 1 or (kind is None) != (target is None):
        raise fail(_USAGE, EXIT_USAGE)
    if show:
        return _list(as_json)
    fault = None if kind is None or target is None else Fault(kind, target, after_s, lasts_s, value or 0.0)
    if fault is not None and value is None and (what := value_missing(fault)):
        raise fail(f"{what}: give --value", EXIT_USAGE)
    with attached(cell, port, hosts, router, refused=EXIT_USAGE) as found:
        if fault is None:
            found.clear()
            done = "cleared: nothing injected acts any more"
        else:
            done = f"{injection.words(fault._asdict())}: {found.inject(fault)}"
    if as_json:
        print(json.dumps({"fault": None if fault is None else fault._asdict(), "done": done}))
    else:
        console.print(done, highlight=False)


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
