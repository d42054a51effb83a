"""What plain data of a user must hold before it is read: not too deep, and every text prints as it stands."""

import unicodedata
from collections.abc import Iterator
from typing import Any

DEEPEST = 32  # tables and lists inside each other; an experiment has seven
_NO_PRINT = ("Cc", "Cf", "Cs", "Zl", "Zp")  # control, direction and line characters: a terminal obeys them


def too_deep(plain: Any) -> bool:
    """Whether tables and lists are nested more than `DEEPEST` deep; found without recursion."""
    level = [plain]
    for _ in range(DEEPEST + 1):
        level = [item for one in level for item in _items(one)]
    return bool(level)


def _items(value: Any) -> list[Any]:
    if isinstance(value, dict):
        return list(value.values())
    return list(value) if isinstance(value, list | tuple) else []


def unprintable(plain: Any, path: str = "") -> Iterator[str]:
    """One line for each text with a character that does not print, with its path."""
    if isinstance(plain, str):
        strange = next((letter for letter in plain if unicodedata.category(letter) in _NO_PRINT), "")
        if strange:
            yield f"{path} has the character U+{ord(strange):04X}: expected text of one line that prints; remove it"
    elif isinstance(plain, dict | list):
        named = plain.items() if isinstance(plain, dict) else enumerate(plain)
        for name, value in named:
            yield from unprintable(value, f"{path}.{name}" if path else str(name))
