"""`hydrohil tune`: the six-step procedure of Appendix C, unattended, on any plant."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrohil.cli.experiment_commands import experiment_of
from hydrohil.cli.options import STUDIES, Settings, app, console, fail, failing, make_folders, writing
from hydrohil.shared.exit_status import EXIT_USAGE
from hydrohil.shared.machine.description import LINKS

if TYPE_CHECKING:
    from hydrohil.experiment.experiment import Experiment
    from hydrohil.tuning.tune import Tuning


@app.command(rich_help_panel=STUDIES)
def tune(
    name: Annotated[str, typer.Argument(help="Experiment whose plant is tuned: name, alias, or a TOML file.")] = "fig-4-25",
    link: Annotated[str, typer.Option(help="rotate, down_up, out_in or all.")] = "all",
    settings: Settings = None,
    seeds: Annotated[int, typer.Option(min=1, max=100, help="Noise seeds of each trial; the worst decides.")] = 3,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write gains and evidence.")] = None,
    toml_file: Annotated[Path | None, typer.Option("--toml", help="Write the experiment with the tuned gains.")] = None,
) -> None:
    """Tune the position controller by the six steps of thesis Appendix C, from trials alone.

    Plant, limits and the gains that no step determines are the experiment's. Each link is tuned in free space with the
    other valves shut, on the patterns of chapter 4 (local clock). What "stable" and "optimum" mean stands with each step.

    Exit status: 0 tuned, 1 a step found no acceptable value, 2 usage.

    Examples: `hydrohil tune --link down_up`,
    `hydrohil tune --set plant.machine.down_up.breakaway_nm=940.0 --toml mine.toml; hydrohil run mine.toml --clock local`
    """
    from hydrohil.cli.tune_report import show

    if link not in (*LINKS, "all"):
        raise fail(f"--link is {link!r}: expected {', '.join(LINKS)}, all; links go by name", EXIT_USAGE)
    make_folders(json_file, toml_file)
    experiment = experiment_of(name, settings)
    with failing("interrupted: nothing written"):
        tuning = _with_bar(experiment, LINKS if link == "all" else (link,), seeds)
    show(console, tuning)
    if json_file is not None:
        with writing(json_file):
            text = json.dumps(tuning.summary(), indent=2, allow_nan=False)
            json_file.write_text(text + "\n", encoding="utf-8")
    if toml_file is not None and tuning.exit_status:
        console.print(f"{toml_file} is not written: not every link is tuned", highlight=False)
    elif toml_file is not None:
        with writing(toml_file):
            toml_file.write_text(tuning.experiment.to_toml(), encoding="utf-8")
    raise typer.Exit(tuning.exit_status)


def _with_bar(experiment: "Experiment", links: tuple[str, ...], seeds: int) -> "Tuning":
    """Tune, showing each step as it is done."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from hydrohil.cli.tune_report import show_step
    from hydrohil.tuning.procedure import STEPS
    from hydrohil.tuning.tune import TuningProgress, tune

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("the first trial after a change compiles", total=STEPS * len(links))

        def observe(now: TuningProgress) -> None:
            if now.step is None:
                progress.update(task, description=f"{now.doing} ({now.trials} trials)")
            else:
                show_step(console, now.link, now.step)
                progress.advance(task)

        return tune(experiment, links=links, seeds=seeds, progress=observe)
