"""`hydrohil tune`: the six-step procedure of Appendix C, unattended, on any plant."""

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrohil.cli.experiment_commands import experiment_of
from hydrohil.cli.options import STUDIES, Settings, app, console, fail, make_folders, writing
from hydrohil.shared.contract.faults import LINKS
from hydrohil.shared.exit_status import EXIT_USAGE

if TYPE_CHECKING:
    from hydrohil.claims.trace import Trace
    from hydrohil.cli.tune_report import TuneReport
    from hydrohil.experiment.experiment import Experiment
    from hydrohil.tuning.bench import Step

CHOICES = {**{name: (number,) for number, name in enumerate(LINKS)}, "all": (0, 1, 2)}


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
    from hydrohil.cli import tune_report as reports
    from hydrohil.experiment.errors import ExperimentError

    if link not in CHOICES:
        raise fail(f"--link is {link!r}: expected {', '.join(CHOICES)}; links go by name", EXIT_USAGE)
    make_folders(json_file, toml_file)
    experiment = experiment_of(name, settings)
    try:
        report = _tune(experiment, CHOICES[link], seeds)
    except ExperimentError as error:
        raise fail(error, EXIT_USAGE) from None
    except KeyboardInterrupt:
        raise fail("interrupted: nothing written", 130) from None
    reports.show(console, report)
    if json_file is not None:
        with writing(json_file):
            reports.write_json(json_file, report)
    if toml_file is not None and report.exit_status:
        console.print(f"{toml_file} is not written: not every link is tuned", highlight=False)
    elif toml_file is not None:
        with writing(toml_file):
            reports.write_toml(toml_file, report)
    raise typer.Exit(report.exit_status)


def _tune(experiment: "Experiment", links: tuple[int, ...], seeds: int) -> "TuneReport":
    """Tune one link after the other on the local clock, showing each step as it is done."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from hydrohil.cli.tune_report import TuneReport, show_step
    from hydrohil.simulation.rollout import rollout
    from hydrohil.tuning.bench import Bench, Criteria
    from hydrohil.tuning.procedure import STEPS, check_place, tune_link

    trials, began = 0, time.perf_counter()
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("the first trial after a change compiles", total=STEPS * len(links))

        def run(trial: "Experiment", seed: int) -> "Trace":
            nonlocal trials
            trace = rollout(trial, seed)
            trials += 1
            progress.update(task, description=f"{trial.title} ({trials} trials)")
            return trace

        def watch(link: int, step: "Step") -> None:
            show_step(console, link, step)
            progress.advance(task)

        benches = [Bench(run, experiment, link, tuple(range(seeds))) for link in links]
        for bench in benches:
            check_place(bench)
        tuned = tuple(tune_link(bench, watch) for bench in benches)
    return TuneReport(experiment, Criteria(), seeds, tuned, trials, time.perf_counter() - began)
