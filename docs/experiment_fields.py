"""Every field that an experiment may have, from the types of its sections: path, type, bounds, default, meaning."""

import ast
import inspect
import re
from collections.abc import Iterator
from math import isfinite
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin, get_type_hints

LINKS = ("rotate", "down_up", "out_in")


def code(value: object) -> str:
    """A value as code."""
    return f"`{value}`"


class Field(NamedTuple):
    """A row of the table of fields."""

    path: str
    kind: str
    bounds: str
    default: str
    meaning: str


def fields(kind: Any, path: str = "", given: Any = None) -> Iterator[Field]:
    """Every field of a section, and of the sections in it; `given` has its defaults where a section that holds it names them."""
    hints, comments = get_type_hints(kind, include_extras=True), comments_of(kind)
    defaults = given._asdict() if isinstance(given, kind) else kind._field_defaults
    alike = hasattr(hints.get(LINKS[0]), "_fields") and len({hints.get(link) for link in LINKS}) == 1
    for name in kind._fields:
        if name in LINKS and alike:
            if name == LINKS[0]:
                yield from _of_each_link(hints[name], f"{path}<link>.")
        else:
            yield from _field(f"{path}{name}", hints[name], defaults.get(name), comments.get(name, ""))


def _of_each_link(kind: Any, path: str) -> Iterator[Field]:
    """Fields of a table that each link has, by the names that a user writes; their defaults differ."""
    from hydrohil.shared.contract.link_units import written_name

    for field in fields(kind):
        name = field.path.strip("`")
        turns, slides = written_name(name, LINKS[0]), written_name(name, LINKS[2])
        other = "" if turns == slides else f"; `{LINKS[2]}`: `{slides}`"
        yield field._replace(path=f"`{path}{turns}`{other}", default="")


def _field(path: str, hint: Any, default: Any, comment: str) -> Iterator[Field]:
    plain, bounds = _unwrapped(hint)
    section = next((part for part in (plain, *get_args(plain)) if hasattr(part, "_fields")), None)
    if section is not None:
        yield from fields(section, f"{path}.", default)
        return
    shown = "" if default is None or default == "" else code(_short(default))
    yield Field(code(path), _type_words(plain), bounds, shown, comment)


def _unwrapped(hint: Any) -> tuple[Any, str]:
    """The type without its bounds, and these in words; of an optional type, the type."""
    if get_origin(hint) in (Union, UnionType):
        hint = next(part for part in get_args(hint) if part is not NoneType)
    if get_origin(hint) is Annotated:
        plain, *marks = get_args(hint)
        return plain, ", ".join(filter(None, map(_bound, marks)))
    return hint, ""


def _bound(mark: Any) -> str:
    words = (("gt", ">"), ("ge", ">="), ("lt", "<"), ("le", "<="))
    found = [f"{sign} {value:g}" for name, sign in words if (value := getattr(mark, name, None)) is not None and isfinite(value)]
    return ", ".join(found)


def _type_words(plain: Any) -> str:
    if get_origin(plain) is Literal:
        return ", ".join(map(code, get_args(plain)))
    if get_origin(plain) is tuple:
        parts = [part for part in get_args(plain) if part is not Ellipsis]
        return "list of " + _type_words(_unwrapped(parts[0])[0])
    return str(getattr(plain, "__name__", plain))


def _short(default: Any) -> str:
    if isinstance(default, float):
        return f"{default:.6g}"
    return "[" + ", ".join(map(_short, default)) + "]" if isinstance(default, tuple) else str(default)


def comments_of(kind: Any) -> dict[str, str]:
    """The comment beside each field in the source."""
    try:
        source = inspect.getsource(kind)
    except (OSError, TypeError):
        return {}
    return {found[1]: found[2] for found in re.finditer(r"^ {4}(\w+): [^#\n]*# (.+)$", source, re.MULTILINE)}


def written_types(kind: Any) -> dict[str, str]:
    """The type of each field as the source has it, without its bounds."""
    (body,) = ast.parse(inspect.getsource(kind)).body
    assert isinstance(body, ast.ClassDef)
    fields_of = [line for line in body.body if isinstance(line, ast.AnnAssign) and isinstance(line.target, ast.Name)]
    return {
        str(ast.unparse(line.target)): re.sub(r"Annotated\[(\w+), .*\]", r"\1", ast.unparse(line.annotation))
        for line in fields_of
    }
