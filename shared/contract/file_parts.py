"""The files of a long recording: `run.rrd`, `run.part2.rrd`, `run.part3.rrd`. Each opens alone, all of them open as one."""

import re
from pathlib import Path

_PART = re.compile(r"(?P<name>.+)\.part(?P<number>[1-9][0-9]*)")


def part(path: Path, number: int) -> Path:
    """The name of the `number`-th file of a recording whose first is `path`; the first is `path` itself."""
    return path if number == 1 else path.with_name(f"{path.stem}.part{number}{path.suffix}")


def parts_of(path: Path) -> list[Path]:
    """Every file there is of the recording that `path` is, or is part of; in order."""
    named = _PART.fullmatch(path.stem)
    first = path.with_name(named["name"] + path.suffix) if named else path
    found = {1: first} if first.exists() else {}
    for sibling in first.parent.glob(f"*{first.suffix}"):
        of = _PART.fullmatch(sibling.stem)
        if of and of["name"] == first.stem:
            found[int(of["number"])] = sibling
    return [found[number] for number in sorted(found)]
