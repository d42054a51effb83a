"""What a type of an experiment's sections says of its parts: the fields of a named tuple, the items of a list."""

from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, get_args, get_origin, get_type_hints


def bare(kind: Any) -> Any:
    """`kind` without annotations and without "or None"."""
    if get_origin(kind) is Annotated or (get_origin(kind) is UnionType and get_args(kind)[-1] is NoneType):
        return bare(get_args(kind)[0])
    return kind


def field_names(kind: Any) -> tuple[str, ...]:
    """Fields of a named tuple; none of anything else."""
    return getattr(bare(kind), "_fields", ())


def child(kind: Any, part: str | int) -> Any:
    """Type of the field, item or value `part` of a `kind`; None where it has none."""
    plain = bare(kind)
    if get_origin(plain) is dict:
        return get_args(plain)[1]
    if isinstance(part, int):
        arguments = get_args(plain) or (None,)
        return arguments[0] if arguments[-1] is Ellipsis else arguments[min(part, len(arguments) - 1)]
    return _hints(plain).get(part) if hasattr(plain, "_fields") else None


@cache
def _hints(kind: Any) -> dict[str, Any]:
    return get_type_hints(kind, include_extras=True)
