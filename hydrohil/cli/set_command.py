"""`hydrohil set`: change the controller's parameters while a trial runs."""

import json
from typing import Annotated, Any

import typer

from hydrohil.cli.cell_commands import await_links
from hydrohil.cli.options import RUNNING_CELL, AsJson, CellName, Port, app, console, fail
from hydrohil.shared.exit_status import EXIT_TRANSPORT, EXIT_USAGE
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.endpoints import DEFAULT_PORT

_ANSWER_S = 10.0  # a stiffness is examined between the samples, along the whole reference


@app.command("set", rich_help_panel=RUNNING_CELL)
def set_parameters(
    assignments: Annotated[list[str], typer.Argument(metavar="PATH=VALUE...", help="As in `hydrohil run --set`.")],
    as_json: AsJson = False,
    cell: CellName = "cell",
    port: Port = DEFAULT_PORT,
) -> None:
    """Change parameters of the controller in a trial that runs, several at once as one change.

    What may change: law, gains, mass, stiffness and damping of the target impedance, numbers of its adaptation. A law takes over
    the current that the valve has, the impedance moves over 0.5 s; the command goes by the tight slew limit meanwhile. After the
    trial the loaded values are back, and its run has no verdict. Limits of gate and supervisor cannot be changed.

    Exit status: 2 a name, a value or the moment is refused, 5 no cell.

    Example: `hydrohil set controller.gains.down_up.kp_a_per_q=3.0 controller.law=pi`
    """
    from hydrohil.cell import processes as cells

    try:
        with cells.operator_bus(cells.Place(cell, port)) as bus:
            await_links(bus)
            made = _ask(bus, assignments)
    except cells.CellError as error:
        raise fail(error, EXIT_TRANSPORT) from None
    if as_json:
        print(json.dumps(made))
        return
    for line in made.get("warnings", ()):
        console.print(f"warning: {line}", highlight=False, markup=False, soft_wrap=True, style="yellow")
    for changed in made["changed"]:
        console.print(f"{changed['path']}: {changed['old']} -> {changed['new']}", highlight=False, markup=False, soft_wrap=True)
    ramp = f", moving over {made['ramp_samples']} samples" if made["ramp_samples"] > 1 else ""
    console.print(f"acts from sample {made['number']}{ramp}", highlight=False)


def _ask(bus: Bus, assignments: list[str]) -> dict[str, Any]:
    """What the controller made of it; exit 2 where it refuses. Raises CellError."""
    from hydrohil.cell import processes as cells

    answer = bus.ask("controller", "parameters", {"set": assignments}, _ANSWER_S)
    if answer is None:
        raise cells.CellError("the controller does not answer: start it (`hydrohil controller`) or see `hydrohil status`")
    if not answer.accepted:
        raise fail(f"refused: {answer.reason}", EXIT_USAGE)
    made: dict[str, Any] = json.loads(answer.values)
    return made
