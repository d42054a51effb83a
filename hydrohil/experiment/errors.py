"""What is wrong with an experiment, in one clear line a problem: where, value, unit, what was expected, what to do."""

import json
import re
from collections.abc import Iterable, Sequence
from types import NoneType, UnionType
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

from hydrohil.shared.contract.assignments import nearest
from hydrohil.shared.errors import HydrohilError

_UNIT_WORDS = {
    **dict.fromkeys(("m", "m2", "m3", "s", "s2", "kg", "rad", "rad2", "deg", "q", "q2", "tau"), ""),
    "n": "N",
    "nm": "N m",
    "nms": "N m s",
    "ns": "N s",
    "a": "A",
    "pa": "Pa",
    "hz": "Hz",
    "substeps": "sub-steps",
    "samples": "",
    "codes": "",
    "counts": "",
    "sqrt": "",
}
Location = Sequence[str | int]


class ExperimentError(HydrohilError, ValueError):
    """An experiment that cannot run; its message has one line a problem."""

    def __init__(self, problems: Iterable[str]) -> None:
        """Keep the lines for a caller that shows them one by one."""
        self.problems = tuple(problems)
        super().__init__("\n".join(self.problems))


def unreadable(path: object, reason: OSError | UnicodeDecodeError) -> ExperimentError:
    """The one line on a file that cannot be read."""
    why = f"no UTF-8 text at byte {reason.start}" if isinstance(reason, UnicodeDecodeError) else reason.strerror or str(reason)
    return ExperimentError([f"{path}: cannot be read ({why}): give the path of a TOML file"])


def unit_of(field: str) -> str:
    """Unit that a field's suffix states: `kp_a_per_q` is in A/q; empty if it states none."""
    words = field.split("_")
    tail: list[str] = []
    while words and (words[-1] in _UNIT_WORDS or (words[-1] == "per" and tail)):
        tail.insert(0, words.pop())
    while tail and tail[0] == "per":
        tail.pop(0)
    over, _, under = " ".join(_UNIT_WORDS.get(word) or word for word in tail).partition(" per ")
    return f"{over}/({under})" if " " in under else f"{over}/{under}" if under else over


def dotted(location: Location) -> str:
    """`("controller", "gains", 1)` as `controller.gains.1`."""
    return ".".join(str(part) for part in location)


def names_at(schema: Any, location: Location) -> tuple[str, ...]:
    """Field names of the tuple type that `location` leads to, empty where it leads elsewhere."""
    for part in location:
        schema = _child(schema, part)
    return tuple(name.rstrip("_") for name in getattr(_bare(schema), "_fields", ()))  # `from_`: a keyword of Python


def _bare(schema: Any) -> Any:
    """Without annotations and without "or None"."""
    if get_origin(schema) is Annotated or (get_origin(schema) is UnionType and get_args(schema)[-1] is NoneType):
        return _bare(get_args(schema)[0])
    return schema


def _child(schema: Any, part: str | int) -> Any:
    bare = _bare(schema)
    if get_origin(bare) is dict:
        return get_args(bare)[1]
    if isinstance(part, int):
        arguments = get_args(bare) or (None,)
        return arguments[0] if arguments[-1] is Ellipsis else arguments[min(part, len(arguments) - 1)]
    return get_type_hints(bare, include_extras=True).get(part) if hasattr(bare, "_fields") else None


class Problem(NamedTuple):
    """One complaint of the validator."""

    location: Location
    kind: str
    value: Any
    expected: str


def line(where: str, problem: Problem, schema: Any) -> str:
    """The problem in words; `where` is the file or the command line."""
    location, name = problem.location, dotted(problem.location)
    known = names_at(schema, location[:-1])
    if problem.kind in ("extra_forbidden", "unexpected_keyword_argument"):
        return f"{where}: {name} is no field: remove it or use one of {nearest(str(location[-1]), known)}"
    if problem.kind in ("missing", "missing_argument"):
        return f"{where}: {name} is missing: add it{_in_unit(location)}"
    return f"{where}: {name} is {_shown(problem.value, location)}: {problem.expected}; correct the value"


def _shown(value: Any, location: Location) -> str:
    try:
        text = json.dumps(value, ensure_ascii=False)
    except (TypeError, ValueError):
        text = str(value)
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return f"{text} {_unit_at(location)}".strip() if number else text


def _unit_at(location: Location) -> str:
    name = next((part for part in reversed(location) if isinstance(part, str)), "")
    slides = 2 in location or "out_in" in location
    joint, force = ("m", "N") if slides else ("rad", "N m")
    return re.sub(r"\btau\b", force, re.sub(r"\bq(2?)\b", rf"{joint}\1", unit_of(name)))


def _in_unit(location: Location) -> str:
    unit = _unit_at(location)
    return f", in {unit}" if unit else ""


def from_validation(where: str, complaints: Iterable[Any], schema: Any) -> ExperimentError:
    """Turn pydantic's list of errors into lines."""
    return ExperimentError(
        line(where, Problem(entry["loc"], entry["type"], entry["input"], _expected(entry["msg"])), schema) for entry in complaints
    )


def _expected(message: str) -> str:
    return message.replace("Input should be", "expected").replace("Tuple should have", "expected")
