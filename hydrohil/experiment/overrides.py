"""Changes to an experiment from the command line: `controller.law=pi`, `controller.gains.down_up.kp_a_per_rad=9.0`."""

from collections.abc import Sequence
from typing import Any

from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import Experiment, from_plain, to_plain
from hydrohil.shared.contract.assignments import parsed, put

WHERE = "--set"


def with_overrides(experiment: Experiment, assignments: Sequence[str]) -> Experiment:
    """`experiment` with `path=value` assignments applied in order, validated as if it had been written so.

    A list element is named by its index or, in a list of three, by its link. Raises ExperimentError.
    """
    plain = to_plain(experiment)
    found: list[str] = []
    for assignment in assignments:
        try:
            _assign(plain, assignment)
        except ExperimentError as refused:
            found += refused.problems
    if found:
        raise ExperimentError(found)
    return from_plain(plain, WHERE)


def _assign(plain: dict[str, Any], assignment: str) -> None:
    try:
        path, value = parsed(assignment)
    except ValueError as refused:
        raise ExperimentError([f"{WHERE} {assignment}: {refused}"]) from None
    assign(plain, path, value, WHERE)


def assign(plain: dict[str, Any], path: str, value: Any, where: str) -> None:
    """Put `value` at a dotted path of an experiment's plain data. Raises ExperimentError; `where` names the origin."""
    try:
        put(plain, path, value)
    except ValueError as refused:
        raise ExperimentError([f"{where} {path}: {refused}"]) from None
