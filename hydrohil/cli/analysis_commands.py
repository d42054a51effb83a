"""`hydrohil linear`: the linearised model of an impedance experiment."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrohil.cli.experiment_commands import experiment_of
from hydrohil.cli.options import STUDIES, AsJson, Settings, app, console, failing, make_folders
from hydrohil.shared.units import A_PER_MA

if TYPE_CHECKING:
    from hydrohil.linear.linearize import Linearization


@app.command(rich_help_panel=STUDIES)
def linear(
    name: Annotated[str, typer.Argument(help="Name, alias, or a TOML file of an impedance experiment.")],
    settings: Settings = None,
    current_ma: Annotated[
        float, typer.Option(help="Spool position as a valve current, at which the orifice is linearised.", min=0.0, max=600.0)
    ] = 120.0,
    ideal: Annotated[bool, typer.Option("--ideal", help="Without delay and spool dynamics, as the thesis has it.")] = False,
    as_json: AsJson = False,
    png: Annotated[Path | None, typer.Option(help="Write Bode plots.")] = None,
) -> None:
    """Poles, margins and steady-state gains of the linearised closed loop (thesis 3.2).

    Dry friction, dead zones and resolution have no place in it: it says nothing about sticking and limit cycles.

    Examples: `hydrohil linear fig-5-5`, `hydrohil linear fig-5-9 --current-ma 60 --png bode.png`
    """
    from hydrohil.linear.linearize import linearize

    make_folders(png)
    experiment = experiment_of(name, settings)
    with failing():
        found = linearize(experiment, current_a=current_ma * A_PER_MA, ideal=ideal)
        if png is not None:
            found.save_bode(png)
    if as_json:
        print(json.dumps(found.summary(), indent=2))
    else:
        _show(found)


def _show(found: "Linearization") -> None:
    from rich.table import Table

    table = Table("pole, 1/s", "frequency, rad/s", "damping")
    for pole in found.poles:
        pair = f" +- {pole.imag_rad_per_s:.4g} j" if pole.imag_rad_per_s > 0.0 else ""
        table.add_row(f"{pole.real_per_s:.4g}{pair}", f"{pole.frequency_rad_per_s:.4g}", f"{pole.damping_ratio:.3f}")
    console.print(f"{found.experiment}, orifice linearised at {found.current_a / A_PER_MA:g} mA", highlight=False)
    console.print(table)
    table = Table("loop", "gain margin", "at, rad/s", "phase margin, deg", "at, rad/s", "modulus margin")
    for words, of in (("1 + R_F A C M_F + R_X A (C + Q_v)", found.loop), ("broken at the valve's current", found.valve_loop)):
        numbers = (of.gain, of.gain_rad_per_s, of.phase_deg, of.phase_rad_per_s, of.modulus)
        table.add_row(words, *(f"{number:.4g}" for number in numbers))
    console.print(table)
    gains = found.steady
    console.print(
        f"at rest: X/X_d {gains.x_per_x_d:.4g}, X/F_d {gains.x_per_f_d_m_per_n:.4g} m/N, "
        f"F/X_d {gains.f_per_x_d_n_per_m:.4g} N/m, F/F_d {gains.f_per_f_d:.4g}",
        highlight=False,
    )
    console.print("stable" if found.stable else "[red]unstable[/]")
