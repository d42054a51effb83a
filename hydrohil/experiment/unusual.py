"""Values ten or more times their default: often a unit was mistaken, such as the thesis' mA/deg for A/rad."""

from collections.abc import Iterator
from typing import Any

FACTOR = 10.0


def unusual(given: Any, usual: Any, path: str = "") -> Iterator[tuple[str, float, float]]:
    """Path, value and default of each number of `given` that is at least ten times its default; both are plain data.

    Lists are compared element by element where both have one; a default of zero has no multiple.
    """
    if isinstance(given, dict) and isinstance(usual, dict):
        for name in given.keys() & usual.keys():
            yield from unusual(given[name], usual[name], f"{path}.{name}" if path else name)
    elif isinstance(given, list) and isinstance(usual, list):
        for number, (value, default) in enumerate(zip(given, usual, strict=False)):
            yield from unusual(value, default, f"{path}.{number}")
    elif _is_number(given) and _is_number(usual) and usual != 0 and abs(given) >= FACTOR * abs(usual):
        yield path, float(given), float(usual)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
