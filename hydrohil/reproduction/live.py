"""`hydrohil reproduce --clock lockstep|real`: one cell, one trial after another, then the same verdicts and plots."""

from collections.abc import Iterable

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from hydrohil.cell import processes as cells
from hydrohil.cell.session import run_live
from hydrohil.cli.run import cell_bus
from hydrohil.reproduction.jobs import Done, jobs, judged
from hydrohil.reproduction.plan import Group
from hydrohil.reproduction.play import Played, simulated_s
from hydrohil.shared.transport.bus import Bus
from hydrohil.thesis.library import find


def reproduce_live(
    place: cells.Place,
    groups: Iterable[Group],
    seeds: int,
    clock: str,
    extra: dict[str, list[str]],
    console: Console,
    *,
    unqualified: bool = False,
) -> list[Done]:
    """Every group with every seed; drawn when the cell has nothing left to do. Raises CellError, TrippedError.

    A trip ends it: the cell may be a machine, and who resets a machine has looked at it. What is left is told as a gap.
    """
    todo = jobs(groups, seeds)
    played: dict[tuple[str, int], Played] = {}
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with cell_bus(place, cells.LOOP, extra, console) as bus, Progress(*columns, console=console) as progress:
        trials = [(name, job.seed) for job in todo for name in job.group.trials]
        task = progress.add_task("", total=sum(simulated_s([find(name)]) for name, _ in trials))
        for name, seed in trials:
            progress.update(task, description=f"{name}, seed {seed}")
            played[name, seed] = _play(bus, name, seed, clock, unqualified=unqualified)
            progress.advance(task, simulated_s([find(name)]))
            if played[name, seed].tripped:
                left = Played(None, gap=f"not played: {name}, seed {seed}, has tripped the rig; it is left so")
                played |= {trial: left for trial in trials if trial not in played}
                break
    with console.status("drawing"):
        return [judged(job, {name: played[name, job.seed] for name in job.group.trials}) for job in todo]


def _play(bus: Bus, name: str, seed: int, clock: str, *, unqualified: bool) -> Played:
    """One trial. Raises CellError, TrippedError."""
    live = run_live(bus, find(name), seed, clock, lambda _: None, unqualified=unqualified)
    return Played(live.trace, live.tripped, live.gap or "; ".join(live.changed))
