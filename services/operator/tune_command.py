"""`hydrohil tune`: the six-step procedure of Appendix C, unattended, on any plant."""

import time
from pathlib import Path
from typing import Annotated, Literal

import typer

from services.operator.experiment_commands import chosen_experiment
from services.operator.options import app, console, fail
from shared.process import EXIT_USAGE

Links = Literal["1", "2", "3", "all"]


@app.command()
def tune(
    name: Annotated[str, typer.Argument(help="Experiment whose plant is tuned: name, alias, or a TOML file.")] = "fig-4-25",
    link: Annotated[str, typer.Option(help="1 (left/right), 2 (down/up), 3 (out/in) or all.")] = "all",
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="PATH=VALUE", help="Change one value.")] = None,
    seeds: Annotated[int, typer.Option(min=1, max=100, help="Noise seeds a trial is played with; the worst decides.")] = 3,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write gains and evidence.")] = None,
    toml_file: Annotated[Path | None, typer.Option("--toml", help="Write the experiment with the tuned gains.")] = None,
) -> None:
    """Tune the position controller by the six steps of thesis Appendix C, from trials alone.

    The plant, the limits and the gains that no step determines are the experiment's; each link is tuned in free space
    with the other valves shut, on the patterns of chapter 4.

    Exit status: 0 tuned, 1 a step found no acceptable value, 2 usage.

    Examples: `hydrohil tune --link 2`,
    `hydrohil tune fig-4-25 --set plant.machine.down_up.breakaway_nm=940.0 --toml mine.toml; hydrohil run mine.toml`
    """
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from experiments.errors import ExperimentError
    from experiments.experiment import Experiment
    from experiments.trace import Trace
    from rollout.rollout import rollout
    from services.operator import tune_report as reports
    from tuning.bench import Bench, Criteria, Step
    from tuning.procedure import STEPS, check_place, tune_link

    if link not in ("1", "2", "3", "all"):
        raise fail(f"--link is {link!r}: expected 1, 2, 3 or all", EXIT_USAGE)
    for path in (json_file, toml_file):
        _make_folder(path)
    experiment = chosen_experiment(name, settings)
    links = (0, 1, 2) if link == "all" else (int(link) - 1,)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    trials, began = 0, time.perf_counter()
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("the first trial after a change compiles", total=STEPS * len(links))

        def run(made: Experiment, seed: int) -> Trace:
            nonlocal trials
            trace = rollout(made, seed)
            trials += 1
            progress.update(task, description=f"{made.title}, {trials} trials")
            return trace

        def watch(step: Step) -> None:
            reports.show_step(console, at, step)
            progress.advance(task)

        done = []
        try:
            benches = [Bench(run, experiment, at, tuple(range(seeds))) for at in links]
            for bench in benches:
                check_place(bench)
            for bench in benches:
                at = bench.link
                done.append(tune_link(bench, watch))
        except ExperimentError as error:
            raise fail(error, EXIT_USAGE) from None
        except KeyboardInterrupt:
            raise fail("interrupted: nothing written", 130) from None
    report = reports.TuneReport(experiment, Criteria(), seeds, tuple(done), trials, time.perf_counter() - began)
    reports.show(console, report)
    if json_file is not None:
        reports.write_json(json_file, report)
    if toml_file is not None:
        if report.exit_status:
            console.print(f"{toml_file} is not written: not every link is tuned", highlight=False)
        else:
            reports.write_toml(toml_file, report)
    raise typer.Exit(report.exit_status)


def _make_folder(path: Path | None) -> None:
    try:
        if path is not None:
            path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise fail(f"{path}: its folder cannot be made ({error.strerror}): name another", EXIT_USAGE) from None
