"""The trials of a campaign, each by its number: point of the grids, repeat, seed, parameters, experiment.

Points are the product of all grids and lists, the last one fastest; trial n is repeat  n mod repeats  of point
n div repeats . Campaign and number are enough to run a trial alone.
"""

import math
import shlex
from collections.abc import Iterator
from itertools import product
from typing import Any, NamedTuple

from hydrohil.campaign.axis import Axis, channel, distribution, draw, values
from hydrohil.campaign.campaign import Campaign, Plan, file_of, measure_claims
from hydrohil.campaign.formula import evaluate
from hydrohil.claims.claims import problems
from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import Experiment, from_plain, to_plain
from hydrohil.experiment.overrides import assign
from hydrohil.shared.contract.assignments import written
from hydrohil.shared.contract.faults import problem
from hydrohil.shared.draws import uniforms

CORNERS = 256  # at most so many combinations of extreme values are validated before anything runs


class Trial(NamedTuple):
    """One trial by its number, before it is run."""

    number: int
    point: int
    repeat: int
    seed: int  # of noise and jitter
    parameters: dict[str, Any]  # by the names of the axes


def points(campaign: Campaign) -> int:
    """Combinations of all grids and lists."""
    return math.prod(len(values(axis)) for axis in campaign.sweep.values() if distribution(axis) is None)


def count(campaign: Campaign) -> int:
    """Number of trials."""
    return points(campaign) * campaign.repeats


def trial_of(campaign: Campaign, number: int) -> Trial:
    """Trial `number`, from 0 on. Raises IndexError beyond the last."""
    if not 0 <= number < count(campaign):
        raise IndexError(f"there is no trial {number}: they go from 0 to {count(campaign) - 1}")
    point, repeat = divmod(number, campaign.repeats)
    rest, parameters = point, {}
    for name, axis in reversed(campaign.sweep.items()):
        if distribution(axis) is not None:
            parameters[name] = draw(axis, name, campaign.seed, repeat)
            continue
        known = values(axis)
        rest, index = divmod(rest, len(known))
        parameters[name] = known[index]
    return Trial(number, point, repeat, campaign.seed + repeat, {name: parameters[name] for name in campaign.sweep})


def assigned(campaign: Campaign, parameters: dict[str, Any]) -> dict[str, Any]:
    """Path and value of every field that the parameters decide. Raises ExperimentError where a formula has no value."""
    values_by_path: dict[str, Any] = {}
    for name, value in parameters.items():
        for path, formula in (campaign.sweep[name].sets or {name: "value"}).items():
            try:
                values_by_path[path] = evaluate(formula, value)
            except ValueError as reason:
                raise ExperimentError([f"sweep.{name}.sets.{path}: {reason}"]) from None
    return values_by_path


def experiment_of(plan: Plan, parameters: dict[str, Any]) -> Experiment:
    """The experiment of these parameters, validated as if it had been written so. Raises ExperimentError."""
    plain, where = to_plain(plan.base), f"{plan.path}: sweep"
    for path, value in assigned(plan.campaign, parameters).items():
        assign(plain, path, value, where)
    return from_plain(plain, where)


def command(plan: Plan, trial: Trial) -> str:
    """The command line that runs this trial alone."""
    campaign = plan.campaign
    settings = ({} if campaign.claims else {"claims": []}) | campaign.set | assigned(campaign, trial.parameters)
    source = str(file_of(campaign, plan.path) or campaign.experiment)
    given = [word for path, value in settings.items() for word in ("--set", written(path, value))]
    return shlex.join(["hydrohil", "run", source, "--clock", "local", "--seed", str(trial.seed), *given])


def probes(campaign: Campaign) -> Iterator[dict[str, Any]]:
    """Parameters that are validated before anything runs.

    Every corner (up to 256) of what the axes reach: first and last of a grid, all of a list, smallest and largest draw.
    A value between is validated when its trial is run; the row of a trial that is refused then says so.
    """
    reached = {name: _ends(campaign, name, axis) for name, axis in campaign.sweep.items()}
    if math.prod(len(ends) for ends in reached.values()) <= CORNERS:
        yield from (dict(zip(reached, corner, strict=True)) for corner in product(*reached.values()))
        return
    middle = {name: ends[0] for name, ends in reached.items()}
    yield from (middle | {name: end} for name, ends in reached.items() for end in ends)


def _ends(campaign: Campaign, name: str, axis: Axis) -> tuple[Any, ...]:
    if axis.list is not None:
        return axis.list
    if axis.grid is not None:
        return (float(axis.grid.from_), float(axis.grid.to))
    shares = uniforms(campaign.seed, channel(name), 0, campaign.repeats)[:, 0]  # a draw grows with its share
    return tuple(draw(axis, name, campaign.seed, int(repeat)) for repeat in (shares.argmin(), shares.argmax()))


def validate(plan: Plan) -> Experiment:
    """Validate every probe and each metric on it; returns the one that lasts longest. Raises ExperimentError."""
    longest, found = plan.base, dict[str, str]()
    for parameters in probes(plan.campaign):
        corner = ", ".join(f"{name} = {value}" for name, value in parameters.items())
        try:
            experiment = experiment_of(plan, parameters)
        except ExperimentError as refused:
            found = dict.fromkeys(refused.problems, corner) | found
            continue
        found = dict.fromkeys(_problems(plan, experiment), corner) | found
        longest = max(longest, experiment, key=lambda one: one.duration_s)
    if found:
        raise ExperimentError(f"{what} (first at {corner})" for what, corner in found.items())
    return longest


def _problems(plan: Plan, experiment: Experiment) -> list[str]:
    """Metrics that do not fit the experiment, and faults that the local clock cannot play."""
    found = [
        f"{plan.path}: metrics.{claim.statement}.{field} {what}"
        for claim in measure_claims(plan.campaign)
        for field, what in problems(claim, experiment.duration_s)
    ]
    unplayed = ((number, problem(fault, "local")) for number, fault in enumerate(experiment.faults))
    return found + [f"{plan.path}: faults.{number}: {what}" for number, what in unplayed if what]
