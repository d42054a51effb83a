"""Figures of the thesis and their claims again, on any clock, as one report."""

import os
import time
from collections.abc import Callable, Sequence
from datetime import datetime
from typing import NamedTuple

from hydrohil.cell.cell import Cell
from hydrohil.experiment.errors import ExperimentError
from hydrohil.reproduction.jobs import Done, jobs
from hydrohil.reproduction.live import reproduce_live
from hydrohil.reproduction.plan import Figure, Group, choose, groups
from hydrohil.reproduction.play import simulated_s
from hydrohil.reproduction.pool import pool
from hydrohil.reproduction.report import Report, gathered, machine, times_real_time
from hydrohil.shared.compiled.kernel import source_version
from hydrohil.thesis.library import find

CLOCKS = ("local", "lockstep", "real")


class ReproductionProgress(NamedTuple):
    """Progress of a reproduction, in seconds of roughly the time that it takes; `total_s` is NaN until processes are ready."""

    doing: str
    done_s: float
    total_s: float


Progress = Callable[[ReproductionProgress], object]


def reproduce(
    what: Sequence[str] = (),
    *,
    seeds: int = 1,
    clock: str = "local",
    workers: int | None = None,
    cell: Cell | None = None,
    unqualified: bool = False,
    progress: Progress = lambda _: None,
) -> Report:
    """Try figures again and judge every claim: chapters (`5`, `appendix`) and figures (`fig-4-25`), all of them if none is named.

    On the local clock `workers` processes share the trials (None: one a core); they are spawned, so a script calls this under
    `if __name__ == "__main__"`. In lockstep and on the real clock the trials run one after another in `cell`, which is opened
    and closed here if it is None; the first trip ends them. A claim must hold in 95 % of the `seeds`.

    `report.exit_status` is 0 where all claims hold; `hydrohil.reproduction.page.page(report)` gives the page as HTML.
    Raises ExperimentError, CellError (TrippedError, UnqualifiedError), LostWorkerError.
    """
    if clock not in CLOCKS:
        raise ExperimentError([f"clock is {clock!r}: expected {', '.join(CLOCKS)}"])
    chosen, began = choose(what), time.perf_counter()
    todo = groups(chosen)
    if clock == "local":
        done = _local(todo, seeds, workers or len(os.sched_getaffinity(0)), progress)
    elif cell is not None:
        done = _live(cell, todo, seeds, clock, progress, unqualified=unqualified)
    else:
        with Cell.open(recorder=False) as own:
            done = _live(own, todo, seeds, clock, progress, unqualified=unqualified)
    return Report(
        gathered(chosen, done),
        clock=clock,
        seeds=seeds,
        source_version=source_version(),
        created_at=datetime.now().astimezone().isoformat(" ", "seconds"),
        duration_s=time.perf_counter() - began,
        machine=machine(),
        command=" ".join(["hydrohil reproduce", *what, f"--seeds {seeds} --clock {clock}"]),
        times_real_time=times_real_time(done),
    )


def live_s(chosen: Sequence[Figure], seeds: int) -> float:
    """Seconds that the trials of `chosen` take in real time."""
    return seeds * simulated_s([find(name) for name in sorted({name for figure in chosen for name in figure.trials})])


def _local(todo: Sequence[Group], seeds: int, workers: int, progress: Progress) -> list[Done]:
    """On the local clock, in processes."""
    work = jobs(todo, seeds)
    progress(ReproductionProgress("starting; compiles once after a change", 0.0, float("nan")))
    done: list[Done] = []
    with pool(min(workers, len(work))) as ready:
        done_s, total_s = 0.0, sum(job.cost_s for job in work)
        progress(ReproductionProgress(f"{len(work)} jobs", done_s, total_s))
        for finished in ready.run(work):
            done.append(finished)
            done_s += finished.job.cost_s
            progress(ReproductionProgress(finished.job.group.figures[0], done_s, total_s))
        progress(ReproductionProgress("done", total_s, total_s))
    return done


def _live(cell: Cell, todo: Sequence[Group], seeds: int, clock: str, progress: Progress, *, unqualified: bool) -> list[Done]:
    """In a cell, one trial after another."""
    begun_s, total_s = 0.0, seeds * sum(simulated_s([find(name)]) for group in todo for name in group.trials)

    def observe(name: str, seed: int) -> None:
        nonlocal begun_s
        progress(ReproductionProgress(f"{name}, seed {seed}", begun_s, total_s))
        begun_s += simulated_s([find(name)])

    done = reproduce_live(cell.bus, todo, seeds, clock, observe, unqualified=unqualified)
    progress(ReproductionProgress("done", total_s, total_s))
    return done
