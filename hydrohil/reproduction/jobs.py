"""What a worker does: play the trials of a group with one seed, judge its figures, and draw them if the job says so."""

import time
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from hydrohil.claims.study import Study
from hydrohil.pages.drawing import Drawing, svg
from hydrohil.pages.panels import Picture, computed, pictures
from hydrohil.reproduction.plan import Figure, Group, find_figure
from hydrohil.reproduction.play import Found, Played, judge_figure, play, simulated_s
from hydrohil.thesis.library import catalogue, find

TIMES_REAL_TIME, DRAWING_S = 400.0, 0.4  # of one core, roughly: they give the order of the jobs and the time that is left
WARM_S = 0.1


class Job(NamedTuple):
    """One group with one seed."""

    group: Group
    seed: int
    draw: bool

    @property
    def simulated_s(self) -> float:
        """Seconds that its trials last."""
        return simulated_s([find(name) for name in self.group.trials])

    @property
    def cost_s(self) -> float:
        """About how long it takes."""
        return self.simulated_s / TIMES_REAL_TIME + (DRAWING_S * len(self.group.figures) if self.draw else 0.0)


class Done(NamedTuple):
    """What a job found."""

    job: Job
    found: tuple[Found, ...]
    drawn: dict[str, tuple[Drawing, ...]]  # by figure
    played_s: float  # wall time of its trials on the local clock; elsewhere 0


def jobs(groups: Iterable[Group], seeds: int) -> tuple[Job, ...]:
    """Every group with every seed, the longest first. The first seed is drawn; a group without trials has one job."""
    all_jobs = [Job(group, seed, seed == 0) for group in groups for seed in range(seeds if group.trials else 1)]
    return tuple(sorted(all_jobs, key=lambda job: -job.cost_s))


def imported() -> None:
    """Do nothing; calling it in a process imports what a job needs."""


def warm() -> None:
    """Compile the loop, or load it from the cache, by playing a tenth of a second of a trial."""
    play(catalogue()[0]._replace(duration_s=WARM_S), 0)


def work(job: Job) -> Done:
    """Play, judge and draw on the local clock."""
    began = time.perf_counter()
    played = {name: play(find(name), job.seed) for name in job.group.trials}
    played_s = time.perf_counter() - began
    return judged(job, played)._replace(played_s=played_s)


def judged(job: Job, played: Mapping[str, Played]) -> Done:
    """Judge and draw trials that were played, whatever the clock."""
    figures = [find_figure(name) for name in job.group.figures]
    found = [judge_figure(figure, played) for figure in figures]
    drawn = {figure.name: _drawn(figure, played, shown) for figure, shown in zip(figures, found, strict=True)} if job.draw else {}
    return Done(job, tuple(shown._replace(panels=()) for shown in found), drawn, 0.0)


def _drawn(figure: Figure, played: Mapping[str, Played], found: Found) -> tuple[Drawing, ...]:
    numbered = enumerate(_pictures(figure, played, found))
    title = figure.subject.title
    return tuple(Drawing(p.title, svg(p, f"{figure.name}-{number}", f"{p.title or 'Plot'}: {title}")) for number, p in numbered)


def _pictures(figure: Figure, played: Mapping[str, Played], found: Found) -> tuple[Picture, ...]:
    if isinstance(figure.subject, Study):
        return computed(found.panels)
    trace = played[figure.name].trace
    return () if trace is None or len(trace.t_s) < 2 else pictures(figure.subject, trace)
