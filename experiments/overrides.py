"""Changes to an experiment from the command line: `controller.law=pi`, `controller.gains.down_up.kp_a_per_rad=9.0`."""

import tomllib
from collections.abc import Sequence
from typing import Any

from experiments.errors import ExperimentError, nearest
from experiments.experiment import Experiment, from_plain, to_plain

LINK_NAMES = ("rotate", "down_up", "out_in")
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
    path, equals, text = assignment.partition("=")
    if not equals or not path.strip():
        raise ExperimentError([f"{WHERE} {assignment}: expected path=value, such as controller.law=pi; write it so"])
    parts = path.strip().split(".")
    place: Any = plain
    for depth in range(len(parts) - 1):
        place = place[_key(place, parts, depth)]
    place[_key(place, parts, len(parts) - 1)] = _value(text.strip())


def _key(place: Any, parts: list[str], depth: int) -> str | int:
    """Key of `parts[depth]` in `place`. Raises ExperimentError with the nearest names."""
    part, inside = parts[depth], ".".join(parts[:depth])
    if isinstance(place, dict):
        if part in place:
            return part
        known = [*place]
    elif isinstance(place, list):
        if part in LINK_NAMES and len(place) == len(LINK_NAMES):
            return LINK_NAMES.index(part)
        if part.isdecimal() and int(part) < len(place):
            return int(part)
        known = [str(index) for index in range(len(place))] + (list(LINK_NAMES) if len(place) == len(LINK_NAMES) else [])
    else:
        raise ExperimentError([f"{WHERE} {'.'.join(parts)}: {inside} is a value without fields; end the path there"])
    hint = nearest(part, known) if known else "nothing: it is empty"
    raise ExperimentError([f"{WHERE} {'.'.join(parts)}: {part} is no field of {inside or 'an experiment'}; use one of {hint}"])


def _value(text: str) -> Any:
    """`text` as a TOML value; what is none is text without quotes."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
