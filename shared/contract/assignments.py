"""`path=value`, by which an operator or an experiment changes one value of plain data: read, put in its place, written again."""

import difflib
import json
import tomllib
from collections.abc import Iterable
from typing import Any

from hydrohil.shared.machine.description import LINKS


def parsed(assignment: str) -> tuple[str, Any]:
    """Path and value of `path=value`, the value as TOML has it; what is no TOML is text without quotes. Raises ValueError."""
    path, equals, text = assignment.partition("=")
    if not equals or not path.strip():
        raise ValueError("expected path=value, such as controller.law=pi; write it so")
    try:
        value = tomllib.loads(f"value = {text.strip()}")["value"]
    except (tomllib.TOMLDecodeError, RecursionError):
        value = text.strip()
    return path.strip(), value


def put(plain: Any, path: str, value: Any) -> None:
    """Put `value` at a dotted path; an item of a list is named by its index, a link by its name. Raises ValueError with names."""
    parts = path.split(".")
    parent = plain
    for depth in range(len(parts) - 1):
        parent = parent[_key(parent, parts, depth)]
    parent[_key(parent, parts, len(parts) - 1)] = value


def written(path: str, value: Any) -> str:
    """`path=value` as it is read: the same value comes out."""
    return f"{path}={text_of(value)}"


def text_of(value: Any) -> str:
    """`value` as a TOML value in one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{name} = {text_of(item)}" for name, item in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(text_of, value)) + "]"
    return json.dumps(value, ensure_ascii=False)


def nearest(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """The names most like `name`; if none is, `otherwise`, or all of them."""
    names = sorted(known)
    return ", ".join(difflib.get_close_matches(name, names, 3, 0.5)) or otherwise or ", ".join(names)


def _key(parent: Any, parts: list[str], depth: int) -> str | int:
    """Key of `parts[depth]` in `parent`."""
    part, inside = parts[depth], ".".join(parts[:depth])
    if isinstance(parent, dict):
        if part in parent:
            return part
        if part.isdecimal() and {*LINKS} <= {*parent}:
            raise ValueError(f"{inside}.{part} is no field: links go by name; use one of {', '.join(LINKS)}")
        known = [*parent]
    elif isinstance(parent, list):
        if part.isdecimal() and int(part) < len(parent):
            return int(part)
        known = [str(index) for index in range(len(parent))]
    else:
        raise ValueError(f"{inside} is a value without fields; end the path there")
    hint = nearest(part, known) if known else "nothing: it is empty"
    raise ValueError(f"{part} is no field of {inside or 'an experiment'}; use one of {hint}")
