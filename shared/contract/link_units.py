"""Fields of a link as a user writes and reads them, in the unit of that link.

The kernels' fields fit every link: `kp_a_per_q`, where q is rad or m (`shared/units.py`). In TOML, on the command line, in error
lines and on the wire, a table with a link's name has that link's unit: `kp_a_per_rad` of `rotate` and `down_up`, `kp_a_per_m` of
`out_in`; likewise `breakaway_nm` and `breakaway_n`. Tables go by the links' names, never by an index.
"""

from collections.abc import Sequence
from functools import cache
from typing import Any

from hydrohil.shared.contract.schema import bare, child, field_names
from hydrohil.shared.machine.description import LINKS

_TURNS = {"q": "rad", "q2": "rad2", "tau": "nm"}
_SLIDES = {"q": "m", "q2": "m2", "tau": "n"}
_UNITS = {"rotate": _TURNS, "down_up": _TURNS, "out_in": _SLIDES}

Location = Sequence[str | int]


def written_name(field: str, link: str) -> str:
    """`field` in the unit of `link`: `kp_a_per_q` is `kp_a_per_m` for `out_in`."""
    units = _UNITS[link]
    return "_".join(units.get(word, word) for word in field.split("_"))


def written_location(location: Location) -> tuple[str | int, ...]:
    """A path through the types as the user writes it: what follows a link's name is in that link's unit."""
    pairs = zip(("", *location), location, strict=False)
    return tuple(written_name(part, before) if before in _UNITS and isinstance(part, str) else part for before, part in pairs)


def plain_of(value: Any, link: str = "") -> Any:
    """Named tuples as dicts by the names that a user writes, tuples as lists, all the way down: every default is spelled out.

    `link` is the link that `value` belongs to, if any.
    """
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        fields = value._asdict().items()
        return {
            written_name(name, link) if link else name: plain_of(field, name if name in LINKS else "") for name, field in fields
        }
    return [plain_of(item) for item in value] if isinstance(value, tuple | list) else value


def as_fields(plain: Any, kind: Any, path: str = "") -> Any:
    """`plain` data that a user wrote, with the names of the fields of `kind`; whatever is unknown stays for the validator.

    A table of one link keeps that link's defaults where it names no value. Raises ValueError with one line where links are given
    as a list or a field in the unit of no link.
    """
    names = field_names(kind)
    if isinstance(plain, list):
        if {*LINKS} <= {*names}:
            raise ValueError(f"{path} is a list: links go by name, write {', '.join(f'{path}.{link}' for link in LINKS)}")
        return [as_fields(item, child(kind, number), _under(path, number)) for number, item in enumerate(plain)]
    if not isinstance(plain, dict):
        return plain
    found = {}
    for name, value in plain.items():
        if name in LINKS and isinstance(value, dict):
            found[name] = _link_table(value, bare(kind), name, _under(path, name))
        else:
            found[name] = as_fields(value, child(kind, name), _under(path, name))
    return found


def _link_table(plain: dict[str, Any], parent: Any, link: str, path: str) -> dict[str, Any]:
    """The table of one link by the names of its fields."""
    kind = child(parent, link)
    fields = _fields_by_written_name(bare(kind), link)
    for name in plain:
        if name not in fields and name in fields.values():
            raise ValueError(f"{path}.{name} is no field: use {written_name(name, link)}")
    default: Any = getattr(parent, "_field_defaults", {}).get(link)
    values: dict[str, Any] = default._asdict() if hasattr(default, "_asdict") else {}
    return values | {fields.get(name, name): value for name, value in plain.items()}


@cache
def _fields_by_written_name(kind: Any, link: str) -> dict[str, str]:
    return {written_name(field, link): field for field in field_names(kind)}


def _under(path: str, part: str | int) -> str:
    return f"{path}.{part}" if path else str(part)
