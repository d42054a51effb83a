"""Changes to an experiment from the command line: `controller.law=pi`, `controller.gains.down_up.kp_a_per_rad=9.0`."""

import json
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
    assign(plain, path.strip(), _value(text.strip()), WHERE)


def assign(plain: dict[str, Any], path: str, value: Any, where: str) -> None:
    """Put `value` at a dotted path of an experiment's plain data. Raises ExperimentError; `where` names the origin."""
    parts = path.split(".")
    place: Any = plain
    for depth in range(len(parts) - 1):
        place = place[_key(place, parts, depth, where)]
    place[_key(place, parts, len(parts) - 1, where)] = value


def assignment(path: str, value: Any) -> str:
    """`path=value` as the command line takes it: the same value comes out."""
    return f"{path}={_text(value)}"


def _text(value: Any) -> str:
    """`value` as a TOML value in one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{name} = {_text(item)}" for name, item in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_text, value)) + "]"
    return json.dumps(value, ensure_ascii=False)


def _key(place: Any, parts: list[str], depth: int, where: str) -> str | int:
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
        raise ExperimentError([f"{where} {'.'.join(parts)}: {inside} is a value without fields; end the path there"])
    hint = nearest(part, known) if known else "nothing: it is empty"
    raise ExperimentError([f"{where} {'.'.join(parts)}: {part} is no field of {inside or 'an experiment'}; use one of {hint}"])


def _value(text: str) -> Any:
    """`text` as a TOML value; what is none is text without quotes."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
