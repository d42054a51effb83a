"""The six steps of Appendix C on every link that is asked for, in one call, and what they have found."""

import math
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from hydrohil.claims.trace import Trace
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import LinkGains
from hydrohil.shared.compiled.kernel import source_version
from hydrohil.shared.contract.assignments import nearest
from hydrohil.shared.contract.link_units import written_name
from hydrohil.shared.errors import UnknownNameError
from hydrohil.shared.exit_status import EXIT_CLAIM, EXIT_OK
from hydrohil.shared.machine.description import LINKS
from hydrohil.simulation.rollout import rollout
from hydrohil.tuning.bench import Bench, Criteria, Step
from hydrohil.tuning.compare import Compared, compare, reference
from hydrohil.tuning.procedure import LinkTuning, check_place, tune_link


class TuningProgress(NamedTuple):
    """What is being tried, and each step when it is done."""

    trials: int  # that were run so far
    doing: str  # title of the trial
    link: str = ""  # of the step
    step: Step | None = None  # that has just been done


class Tuning(NamedTuple):
    """Every link that was tuned, with the evidence of each step."""

    before: Experiment
    criteria: Criteria
    seeds: int
    links: tuple[LinkTuning, ...]
    trials: int
    wall_s: float

    @property
    def exit_status(self) -> int:
        """1 if a step of a link found no acceptable value."""
        return EXIT_OK if all(link.gains is not None for link in self.links) else EXIT_CLAIM

    @property
    def experiment(self) -> Experiment:
        """The experiment with the gains of every link that was tuned, under a name of its own."""
        before, tuned = self.before, {LINKS[link.link]: link.gains for link in self.links if link.gains is not None}
        return before._replace(
            name=f"{before.name}-tuned",
            alias=f"{before.alias}-tuned",
            title=f"{before.title}, tuned gains",
            controller=before.controller._replace(gains=before.controller.gains._replace(**tuned)),
        )

    def compared(self, link: LinkTuning) -> tuple[str, tuple[Compared, ...]]:
        """What a link's gains are set against, and a row a gain."""
        name, gains = reference(self.before.plant, self.before.controller.gains)
        return name, compare(link, name, gains[link.link], self.criteria)

    def summary(self) -> dict[str, Any]:
        """Gains and evidence for JSON: what `hydrohil tune --json` writes; a number that no trial determined is None."""
        return {
            "experiment": self.before.name,
            "seeds": self.seeds,
            "criteria": self.criteria._asdict(),
            "trials": self.trials,
            "wall_s": self.wall_s,
            "exit_status": self.exit_status,
            "source_version": source_version(),
            "links": [_link(self, link) for link in self.links],
        }


def tune(
    experiment: Experiment,
    *,
    links: Sequence[str] = LINKS,
    seeds: int = 3,
    progress: Callable[[TuningProgress], object] = lambda _: None,
) -> Tuning:
    """Tune the position controller by the six steps of thesis Appendix C, from trials on the local clock alone.

    `links` are some of `rotate`, `down_up`, `out_in`. Plant, limits and the gains that no step determines are the experiment's.
    Each link is tuned in free space with the other valves shut; of `seeds` noise seeds the worst decides. `progress` is
    called after each trial, and with each step that is done. Raises UnknownNameError for a link that is none, ExperimentError
    where the patterns leave a link's travel.
    """
    for name in links:
        if name not in LINKS:
            raise UnknownNameError(f"link is {name!r}: expected one of {nearest(name, LINKS)}")
    began, trials = time.perf_counter(), 0

    def run(trial: Experiment, seed: int) -> Trace:
        nonlocal trials
        trace = rollout(trial, seed)
        trials += 1
        progress(TuningProgress(trials, trial.title))
        return trace

    def observe(link: int, step: Step) -> None:
        progress(TuningProgress(trials, step.title, LINKS[link], step))

    benches = [Bench(run, experiment, LINKS.index(name), tuple(range(seeds))) for name in links]
    for bench in benches:
        check_place(bench)
    tuned = tuple(tune_link(bench, observe) for bench in benches)
    return Tuning(experiment, Criteria(), seeds, tuned, trials=trials, wall_s=time.perf_counter() - began)


def _link(tuning: Tuning, link: LinkTuning) -> dict[str, Any]:
    name, rows = tuning.compared(link)
    return {
        "link": LINKS[link.link],
        "steps": [_step(step) for step in link.steps],
        "gains": None if link.gains is None else _si(link.gains, LINKS[link.link]),
        "compared_with": name,
        "compared": [row._asdict() | {"ratio": _number(row.ratio)} for row in rows],
        "worth": [
            {written_name(name, LINKS[link.link]): _number(value) for name, value in one._asdict().items()} for one in link.worth
        ],
    }


def _step(step: Step) -> dict[str, Any]:
    rows = [dict(zip(step.columns, map(_number, row), strict=True)) for row in step.rows]
    return {"number": step.number, "title": step.title, "rule": step.rule, "evidence": rows, "decision": step.decision}


def _si(gains: LinkGains, link: str) -> dict[str, float]:
    return {written_name(name, link): float(value) for name, value in gains._asdict().items()}


def _number(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
