"""Traces as files, by the name's suffix: `.npz` (numpy), `.csv` (text, one line a sample), `.parquet` (columns)."""

import csv
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from hydrohil.claims.trace import Trace
from hydrohil.shared.errors import FileError, MissingPackageError

LINKS, AXES = ("rotate", "down_up", "out_in"), ("x", "y", "z")
_PARTS: dict[str, tuple[str, ...]] = dict.fromkeys(("q", "q_set", "qd", "qd_set", "current_a", "dac_counts"), LINKS)
_PARTS |= dict.fromkeys(("x_m", "x_set_m", "x_nominal_m"), AXES)
_PARTS |= {"encoder_counts": ("0", "1", "2", "3", "4")}
_WHOLE = ("tick", "mode", "encoder_counts", "force_counts", "dac_counts")


def column_names(name: str) -> tuple[str, ...]:
    """Names of a field's columns in a table: `force_n`; `q.rotate` a link; `x_m.x` an axis; `encoder_counts.0`."""
    return tuple(f"{name}.{part}" for part in _PARTS[name]) if name in _PARTS else (name,)


def columns(trace: Trace) -> dict[str, Any]:
    """The trace as a flat table: arrays (n,) by the names of `column_names`, in the order of the trace's fields."""
    table: dict[str, Any] = {}
    for name, values in trace._asdict().items():
        names = column_names(name)
        table |= {names[0]: values} if len(names) == 1 else {column: values[:, k] for k, column in enumerate(names)}
    return table


def of_columns(table: dict[str, Any], path: Path) -> Trace:
    """The trace of a flat table. Raises FileError if a column is missing."""
    _all_there(path, [column for name in Trace._fields for column in column_names(name)], table)
    fields: dict[str, Any] = {}
    for name in Trace._fields:
        kind = np.int64 if name in _WHOLE else np.float64
        parts = [np.asarray(table[column], dtype=kind) for column in column_names(name)]
        fields[name] = parts[0] if len(parts) == 1 else np.column_stack(parts)
    return Trace(**fields)


def _all_there(path: Path, expected: list[str], found: Any) -> None:
    if missing := [name for name in expected if name not in found]:
        raise FileError(f"{path} is no trace: it has no column {', '.join(missing)}")


def _write_npz(trace: Trace, path: Path) -> None:
    fields: dict[str, Any] = trace._asdict()
    with path.open("wb") as file:  # a file, because numpy appends a suffix to a bare name
        np.savez_compressed(file, **fields)


def _read_npz(path: Path) -> Trace:
    try:
        with np.load(path, allow_pickle=False) as fields:
            _all_there(path, [*Trace._fields], fields)
            return Trace(**{name: fields[name] for name in Trace._fields})
    except (ValueError, AttributeError, zipfile.BadZipFile, EOFError) as reason:
        raise reason if isinstance(reason, FileError) else FileError(f"{path} is no trace: {reason}") from None


def _write_csv(trace: Trace, path: Path) -> None:
    table = columns(trace)
    with path.open("w", newline="", encoding="utf-8") as file:
        lines = csv.writer(file)
        lines.writerow(table)
        lines.writerows(zip(*(column.tolist() for column in table.values()), strict=True))  # the shortest exact digits


def _read_csv(path: Path) -> Trace:
    with path.open(newline="", encoding="utf-8") as file:
        try:
            header, *lines = csv.reader(file)
            return of_columns(dict(zip(header, zip(*lines, strict=True), strict=True)), path)
        except (ValueError, csv.Error) as reason:
            raise reason if isinstance(reason, FileError) else FileError(f"{path} is no trace: {reason}") from None


def _parquet() -> Any:
    try:
        import pyarrow.parquet
    except ImportError:
        raise MissingPackageError("a .parquet file needs pyarrow: `pip install pyarrow`, or name a .npz or .csv file") from None
    return pyarrow


def _write_parquet(trace: Trace, path: Path) -> None:
    arrow = _parquet()
    arrow.parquet.write_table(arrow.table(columns(trace)), path)


def _read_parquet(path: Path) -> Trace:
    arrow = _parquet()
    try:
        table = arrow.parquet.read_table(path)
    except arrow.ArrowException as reason:
        raise FileError(f"{path} is no trace: {reason}") from None
    return of_columns({name: table.column(name).to_numpy() for name in table.column_names}, path)


class Format(NamedTuple):
    """How one kind of file is written and read."""

    write: Callable[[Trace, Path], None]
    read: Callable[[Path], Trace]


FORMATS = {
    ".npz": Format(_write_npz, _read_npz),
    ".csv": Format(_write_csv, _read_csv),
    ".parquet": Format(_write_parquet, _read_parquet),
}


def format_of(path: Path) -> Format:
    """How `path` is written and read, by its suffix. Raises FileError."""
    if path.suffix not in FORMATS:
        raise FileError(f"{path}: a trace is written to and read from {', '.join(FORMATS)}: name such a file")
    return FORMATS[path.suffix]


def write_trace(trace: Trace, path: str | Path) -> None:
    """Write a trace as `.npz`, `.csv` or `.parquet`, by the suffix; the same numbers are read back, bit for bit.

    A table has a column a link (`q.down_up`) or axis (`x_m.z`). Raises FileError for another suffix, OSError where the
    file cannot be written, MissingPackageError for `.parquet` without pyarrow.
    """
    format_of(Path(path)).write(trace, Path(path))


def read_trace(path: str | Path) -> Trace:
    """Read the trace that `write_trace` or `hydrohil run --trace` wrote: numpy arrays, a row a sample.

    Raises FileError if it is no trace, OSError if it cannot be read, MissingPackageError for `.parquet` without pyarrow.
    """
    return format_of(Path(path)).read(Path(path))
