"""Every figure again in a live cell: one trial after another, then the same verdicts and plots as on the local clock."""

from collections.abc import Callable, Iterable

from hydrohil.cell.session import run_live
from hydrohil.reproduction.jobs import Done, jobs, judged
from hydrohil.reproduction.plan import Group
from hydrohil.reproduction.play import Played
from hydrohil.shared.transport.bus import Bus
from hydrohil.thesis.library import find

Progress = Callable[[str, int], None]  # name of the trial's experiment and its seed


def reproduce_live(
    bus: Bus, groups: Iterable[Group], seeds: int, clock: str, progress: Progress, *, unqualified: bool = False
) -> list[Done]:
    """Every group with every seed; drawn when the cell has nothing left to do. Raises CellError, TrippedError.

    `progress` is called before each trial. A trip ends the series: the cell may be a real machine, which a person
    must look at before a reset. The trials that are left are reported as gaps.
    """
    todo = jobs(groups, seeds)
    played: dict[tuple[str, int], Played] = {}
    trials = [(name, job.seed) for job in todo for name in job.group.trials]
    for name, seed in trials:
        progress(name, seed)
        played[name, seed] = _play(bus, name, seed, clock, unqualified=unqualified)
        if played[name, seed].tripped:
            left = Played(None, gap=f"not played: {name}, seed {seed}, has tripped the rig; it is left so")
            played |= {trial: left for trial in trials if trial not in played}
            break
    return [judged(job, {name: played[name, job.seed] for name in job.group.trials}) for job in todo]


def _play(bus: Bus, name: str, seed: int, clock: str, *, unqualified: bool) -> Played:
    """One trial. Raises CellError, TrippedError."""
    live = run_live(bus, find(name), seed, clock, lambda _: None, unqualified=unqualified)
    return Played(live.trace, live.tripped, live.gap or "; ".join(live.changed))
