"""`hydrohil plant`, `controller`, `supervisor`, `recorder`, `router`: one process each, in the foreground."""

import typer

from hydrohil.cli.options import SERVICES, app

_PASS_ON = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}


@app.command(context_settings=_PASS_ON, rich_help_panel=SERVICES)
def plant(context: typer.Context) -> None:
    """Run the plant (emulator and gate) in the foreground; `hydrohil plant --help` lists its options."""
    from hydrohil.services.plant.main import main as run_plant

    raise typer.Exit(run_plant(context.args))


@app.command(context_settings=_PASS_ON, rich_help_panel=SERVICES)
def controller(context: typer.Context) -> None:
    """Run the controller in the foreground."""
    from hydrohil.services.controller.service import main as run_controller

    raise typer.Exit(run_controller(context.args))


@app.command(context_settings=_PASS_ON, rich_help_panel=SERVICES)
def supervisor(context: typer.Context) -> None:
    """Run the supervisor in the foreground."""
    from hydrohil.services.supervisor.service import main as run_supervisor

    raise typer.Exit(run_supervisor(context.args))


@app.command(context_settings=_PASS_ON, rich_help_panel=SERVICES)
def recorder(context: typer.Context) -> None:
    """Run the recorder in the foreground."""
    from hydrohil.services.recorder.service import main as run_recorder

    raise typer.Exit(run_recorder(context.args))


@app.command(context_settings=_PASS_ON, rich_help_panel=SERVICES)
def router(context: typer.Context) -> None:
    """Run a router in the foreground: cells whose services do not reach each other meet there."""
    from hydrohil.services.router.service import main as run_router

    raise typer.Exit(run_router(context.args))
