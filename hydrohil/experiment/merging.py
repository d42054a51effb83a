"""A short experiment file: what it does not say is that of its `base`, or the default. Pure: plain data in, plain data out."""

import re
from pathlib import Path
from typing import Any

NAME = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")


def merged(under: Any, over: Any) -> Any:
    """`over` laid on `under`: a table keeps the keys that `over` does not name; anything else, a list too, is replaced."""
    if isinstance(under, dict) and isinstance(over, dict):
        return under | {key: merged(under.get(key), value) for key, value in over.items()}
    return over


def named(plain: dict[str, Any], path: Path, base: str = "") -> dict[str, Any]:
    """`plain` with what a file may leave out: name, alias, title and source.

    The name is the file's, where it can be one; alias and title repeat it; the source names the file and the base.
    """
    stem = path.stem.lower().replace("_", "-")
    name = plain.get("name", stem if NAME.fullmatch(stem) else "experiment")
    source = f"{path.name}, on {base}" if base else path.name
    return {"name": name, "alias": name, "title": name, "source": source} | plain
