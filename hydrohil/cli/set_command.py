"""`hydrohil set`: change the controller's parameters while a trial runs."""

import json
from typing import Annotated

import typer

from hydrohil.cli.options import RUNNING_CELL, AsJson, CellName, Port, app, attached, console
from hydrohil.shared.exit_status import EXIT_USAGE
from hydrohil.shared.transport.endpoints import DEFAULT_PORT


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

    Example: `hydrohil set controller.gains.down_up.kp_a_per_rad=3.0 controller.law=pi`
    """
    with attached(cell, port, refused=EXIT_USAGE) as found:
        answer = found.set_parameters(assignments)
    if as_json:
        print(json.dumps(answer))
        return
    for line in answer.get("warnings", ()):
        console.print(f"warning: {line}", highlight=False, markup=False, soft_wrap=True, style="yellow")
    for changed in answer["changed"]:
        console.print(f"{changed['path']}: {changed['old']} -> {changed['new']}", highlight=False, markup=False, soft_wrap=True)
    ramp = f", moving over {answer['ramp_samples']} samples" if answer["ramp_samples"] > 1 else ""
    console.print(f"acts from sample {answer['number']}{ramp}", highlight=False)
