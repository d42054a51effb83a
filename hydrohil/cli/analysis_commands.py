"""`hydrohil linear`: the linearised model of an impedance experiment."""

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from hydrohil.cli.experiment_commands import experiment_of
from hydrohil.cli.options import STUDIES, AsJson, Settings, app, console, fail, make_folders
from hydrohil.shared.exit_status import EXIT_USAGE
from hydrohil.shared.units import A_PER_MA

_SHOWN = (0.01, 30.0)  # Hz, of the Bode plots


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
    make_folders(png)
    experiment = experiment_of(name, settings)
    from hydrohil.linear.closed_loop import is_stable, loop_margins, poles, steady
    from hydrohil.linear.linear import OperatingPoint, linear_model

    try:
        model = linear_model(experiment, OperatingPoint(current_ma * A_PER_MA))
    except ValueError as error:
        raise fail(f"{name}: {error}", EXIT_USAGE) from None
    model = model.as_in_the_thesis() if ideal else model
    found = {
        "experiment": experiment.name,
        "current_ma": current_ma,
        "stable": is_stable(model),
        "poles": [pole._asdict() for pole in poles(model)],
        "loop": loop_margins(model)[0]._asdict(),
        "valve_loop": loop_margins(model)[1]._asdict(),
        "steady": steady(model)._asdict(),
    }
    if png is not None:
        _plot(model, png, f"{experiment.name} at {current_ma:g} mA")
    if as_json:
        print(json.dumps(_finite(found), indent=2))
        return
    _print(found)


def _finite(value: Any) -> Any:
    """JSON knows neither infinity nor NaN: null."""
    if isinstance(value, dict):
        return {name: _finite(item) for name, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not abs(value) < float("inf") else value


def _print(found: dict[str, Any]) -> None:
    from rich.table import Table

    table = Table("pole, 1/s", "frequency, rad/s", "damping")
    for pole in found["poles"]:
        pair = f" +- {pole['imag_rad_per_s']:.4g} j" if pole["imag_rad_per_s"] > 0.0 else ""
        table.add_row(f"{pole['real_per_s']:.4g}{pair}", f"{pole['frequency_rad_per_s']:.4g}", f"{pole['damping_ratio']:.3f}")
    console.print(f"{found['experiment']}, orifice linearised at {found['current_ma']:g} mA", highlight=False)
    console.print(table)
    table = Table("loop", "gain margin", "at, rad/s", "phase margin, deg", "at, rad/s", "modulus margin")
    for key, words in (("loop", "1 + R_F A C M_F + R_X A (C + Q_v)"), ("valve_loop", "broken at the valve's current")):
        seen = found[key]
        numbers = (seen["gain"], seen["gain_rad_per_s"], seen["phase_deg"], seen["phase_rad_per_s"], seen["modulus"])
        table.add_row(words, *(f"{number:.4g}" for number in numbers))
    console.print(table)
    gains = found["steady"]
    console.print(
        f"at rest: X/X_d {gains['x_per_x_d']:.4g}, X/F_d {gains['x_per_f_d_m_per_n']:.4g} m/N, "
        f"F/X_d {gains['f_per_x_d_n_per_m']:.4g} N/m, F/F_d {gains['f_per_f_d']:.4g}",
        highlight=False,
    )
    console.print("stable" if found["stable"] else "[red]unstable[/]")


def _plot(model: Any, path: Path, title: str) -> None:
    """Bode plots of both loops and of what follows the set-points."""
    from hydrohil.linear.bode import save_bode

    try:
        save_bode(model, path, title, _SHOWN)
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        raise fail(f"{path}: cannot be written ({why}): name a .png file elsewhere", EXIT_USAGE) from None
