"""`hydrohil faults --list`: what the fault test tries, before anything is started."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hydrohil.cli.options import console, make_folders, writing
from hydrohil.faulttest.trial import ByTests, NotTried, Row, Way

STDOUT = Path("-")


def show(rows: Sequence[Row]) -> None:
    """A table: fault, what must happen, within which bound, how it is tried."""
    from rich.table import Table

    table = Table("#", "fault", "must", "bound", "tried")
    for row in rows:
        table.add_row(row.number, row.fault, row.must, row.bound, "\n".join(f"{way.letter}: {way.words}" for way in row.ways))
    console.print(table)
    console.print("T: sample period; lease: longest age of a command or permit", highlight=False)
    console.print("W: real processes on the wall clock; L: to the tick, local or lockstep; P: by tests; -: not tried")


def write_json(rows: Sequence[Row], file: Path) -> None:
    """The same as JSON, into `file`; `-` is the standard output."""
    text = json.dumps([_plain(row) for row in rows], indent=2)
    if file == STDOUT:
        print(text)
        return
    make_folders(file)
    with writing(file):
        file.write_text(text + "\n", encoding="utf-8")


def _plain(row: Row) -> dict[str, Any]:
    return row._asdict() | {"ways": [_way(way) for way in row.ways]}


def _way(way: Way) -> dict[str, Any]:
    tests = {"tests": list(way.tests)} if isinstance(way, ByTests) else {}
    return {"letter": way.letter, "words": way.words, "tried": not isinstance(way, NotTried)} | tests
