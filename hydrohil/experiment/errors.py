"""What is wrong with an experiment, in one clear line a problem: where, value, unit, what was expected, what to do."""

import json
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from hydrohil.shared.contract.assignments import nearest
from hydrohil.shared.contract.link_units import written_location, written_name
from hydrohil.shared.contract.schema import child, field_names
from hydrohil.shared.errors import HydrohilError
from hydrohil.shared.machine.description import LINKS

_UNIT_WORDS = {
    **dict.fromkeys(("m", "m2", "m3", "s", "s2", "kg", "rad", "rad2", "deg"), ""),
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
    """Unit that a field's suffix states: `kp_a_per_rad` is in A/rad; empty if it states none."""
    words = field.split("_")
    tail: list[str] = []
    while words and (words[-1] in _UNIT_WORDS or (words[-1] == "per" and tail)):
        tail.insert(0, words.pop())
    while tail and tail[0] == "per":
        tail.pop(0)
    over, _, under = " ".join(_UNIT_WORDS.get(word) or word for word in tail).partition(" per ")
    return f"{over}/({under})" if " " in under else f"{over}/{under}" if under else over


def dotted(location: Location) -> str:
    """`("reference", 1)` as `reference.1`."""
    return ".".join(str(part) for part in location)


def names_at(schema: Any, location: Location) -> tuple[str, ...]:
    """Names that a user may write in the table that `location` leads to, none where it leads elsewhere."""
    for part in location:
        schema = child(schema, part)
    names = (name.rstrip("_") for name in field_names(schema))  # `from_`: a keyword of Python
    link = location[-1] if location else ""
    return tuple(written_name(name, link) if link in LINKS else name for name in names)


class Problem(NamedTuple):
    """One complaint of the validator."""

    location: Location
    kind: str
    value: Any
    expected: str


def line(where: str, problem: Problem, schema: Any) -> str:
    """The problem in words; `where` is the file or the command line."""
    location = written_location(problem.location)
    name, known = dotted(location), names_at(schema, location[:-1])
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
    """Unit of the value at `location`: `initial_q` of `out_in` is in m."""
    names = [part for part in location if isinstance(part, str)]
    link = names.pop() if len(names) > 1 and names[-1] in LINKS else ""
    return unit_of(written_name(names[-1], link) if link else names[-1]) if names else ""


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
