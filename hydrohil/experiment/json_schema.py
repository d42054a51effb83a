"""What an experiment's file may hold, as a JSON Schema: names as a user writes them, units, bounds, choices.

It is derived from the types that validate: one source for `show --schema`, for the comments of `show --toml`, and for editors.
"""

import math
from collections.abc import Iterator, Mapping
from functools import cache
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from annotated_types import GroupedMetadata

from hydrohil.experiment.errors import unit_of
from hydrohil.experiment.experiment import Experiment
from hydrohil.shared.contract.link_units import written_name
from hydrohil.shared.machine.description import LINKS

Schema = dict[str, Any]
DIALECT = "https://json-schema.org/draft/2020-12/schema"
_SCALARS: dict[type, str] = {bool: "boolean", int: "integer", float: "number", str: "string"}
_BOUNDS = {"ge": "minimum", "gt": "exclusiveMinimum", "le": "maximum", "lt": "exclusiveMaximum"}


@cache
def experiment_schema() -> Schema:
    """The schema of what `hydrohil show NAME --json` prints, draft 2020-12. A number's unit stands in `unit`."""
    return {"$schema": DIALECT, "title": "hydrohil experiment", **_table(Experiment)}


def _table(kind: Any, link: str = "") -> Schema:
    """A named tuple. What `link` owns has that link's units."""
    hints = get_type_hints(kind, include_extras=True)
    properties = {}
    for field, annotation in hints.items():
        owner = field if field in LINKS else link
        name = written_name(field, link) if link else field.rstrip("_")
        properties[name] = _node(annotation, name, owner if field in LINKS or link else "")
    required = [name for name, field in zip(properties, hints, strict=True) if field not in kind._field_defaults]
    return {"type": "object", "properties": properties, "required": required, "additionalProperties": False}


def _node(annotation: Any, name: str, link: str) -> Schema:
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _node(arguments[0], name, link) | dict(_facts(arguments[1:]))
    if origin in (Union, UnionType):  # of the first with None
        return {"anyOf": [_node(arguments[0], name, link), {"type": "null"}]}
    if origin is Literal:
        return {"enum": list(arguments)}
    if origin is tuple:
        return _array(arguments, name, link)
    if hasattr(annotation, "_fields"):
        return _links_of(_table(annotation, link if link in LINKS else ""), name)
    unit = unit_of(name)
    return {"type": _SCALARS[annotation]} | ({"unit": unit} if unit and annotation in (int, float) else {})


def _array(arguments: tuple[Any, ...], name: str, link: str) -> Schema:
    if arguments[-1] is Ellipsis:
        return {"type": "array", "items": _node(arguments[0], name, link)}
    items = [_node(each, name, link) for each in arguments]
    return {"type": "array", "prefixItems": items, "minItems": len(items), "maxItems": len(items)}


def _links_of(table: Schema, name: str) -> Schema:
    """A table of one number a link, such as `initial_q`: each number has its link's unit, which the table's name states."""
    for link, node in table["properties"].items():
        if link in LINKS and node.get("type") in ("number", "integer") and (unit := unit_of(written_name(name, link))):
            node["unit"] = unit
    return table


def _facts(metadata: tuple[Any, ...]) -> Iterator[tuple[str, Any]]:
    """Bounds and patterns of an annotation; an infinite bound is none."""
    for fact in metadata:
        for each in fact if isinstance(fact, GroupedMetadata) else (fact,):
            for attribute, word in _BOUNDS.items():
                bound = getattr(each, attribute, None)
                if bound is not None and math.isfinite(bound):
                    yield word, bound
        if pattern := getattr(fact, "pattern", None):
            yield "pattern", pattern


def at(schema: Schema, path: tuple[str, ...]) -> Schema:
    """The node of a value at `path`, in the names that a user writes; a list stands for its items; {} if there is none."""
    for part in path:
        table = schema.get("items", schema)
        schema = table.get("properties", {}).get(part, {})
    node: Schema = schema.get("anyOf", [schema])[0]
    return node


def in_words(node: Mapping[str, Any]) -> str:
    """Unit and bounds of a value in words: `A/rad, at least 0`; the choices of one that has choices; "" where all is free."""
    if "enum" in node:
        return "one of " + ", ".join(map(str, node["enum"]))
    if "prefixItems" in node:
        return "; ".join(map(in_words, node["prefixItems"]))
    if node.get("type") == "boolean":
        return "true or false"
    words = {"exclusiveMinimum": "above", "minimum": "at least", "exclusiveMaximum": "below", "maximum": "at most"}
    unit = [node["unit"]] if "unit" in node else []
    return ", ".join(unit + [f"{word} {node[key]:g}" for key, word in words.items() if key in node])
