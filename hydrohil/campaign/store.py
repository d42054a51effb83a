"""The rows of a campaign on the disk: a part for each finished chunk, then one Parquet file; a kill loses no part.

A part is written under another name, brought to the disk and renamed, so that it is there whole or not at all; the file is
put together likewise. Both know which campaign, sources and seed they are of: nothing is mixed.
"""

import fcntl
import json
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import pyarrow as pa
import pyarrow.parquet as pq

from hydrohil.campaign.campaign import Plan
from hydrohil.campaign.table import identity, known_identity, schema, table
from hydrohil.campaign.work import Row
from hydrohil.shared.compiled.kernel import source_version
from hydrohil.shared.errors import HydrohilError

_WORDS = {
    "campaign": "another campaign: its experiment, parameters, metrics or repeats have changed",
    "sources": "other sources of this project",
    "seed": "another seed",
    "trials": "another number of trials",
}
PARTS = "*.arrow"
AGAIN = "name another folder with --out, or start anew with --fresh"


class StoreError(HydrohilError):
    """The folder cannot take this campaign; one line that says why and what to do."""


class Store(NamedTuple):
    """A folder that is locked for one campaign."""

    plan: Plan
    sources: str
    final: Path
    parts: Path
    columns: pa.Schema

    def finished(self) -> pa.Table | None:
        """The whole table, if it is there."""
        return pq.read_table(self.final) if self.final.exists() else None

    def kept(self) -> pa.Table:
        """Every row of every part. A part that cannot be read is removed: its trials run again."""
        tables = [self.columns.empty_table()]
        for path in sorted(self.parts.glob(PARTS)):
            try:
                with pa.OSFile(str(path)) as file:
                    tables.append(pa.ipc.open_file(file).read_all().cast(self.columns))
            except (pa.ArrowInvalid, OSError):
                path.unlink()
        return pa.concat_tables(tables)

    def keep(self, rows: list[Row]) -> None:
        """One part of rows that no other part has."""
        part = table(rows, self.columns)

        def write(path: Path) -> None:
            with pa.OSFile(str(path), "wb") as sink, pa.ipc.new_file(sink, self.columns) as writer:
                writer.write_table(part)

        _whole(self.parts / f"{rows[0]['trial']:012d}.arrow", write)

    def finish(self) -> pa.Table:
        """Write one file of all parts, in the order of the trials, then delete the parts."""
        whole = self.kept().sort_by("trial").combine_chunks()
        _whole(self.final, lambda path: pq.write_table(whole, path, compression="zstd"))
        shutil.rmtree(self.parts)
        return whole


def _whole(path: Path, write: Callable[[Path], None]) -> None:
    """Write `path` whole or not at all, also through a crash of the machine. Raises StoreError."""
    part = path.with_name(f".{path.name}.new")
    try:
        write(part)
        descriptor = os.open(part, os.O_RDONLY)
        os.fsync(descriptor)
        os.close(descriptor)
        part.replace(path)
    except OSError as reason:
        raise StoreError(f"{path}: cannot be written ({reason}): make room, and the same command goes on") from None


@contextmanager
def opened(plan: Plan, folder: Path, *, fresh: bool) -> Iterator[Store]:
    """The folder, locked. Raises StoreError if it holds something else, or another process is at work."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as reason:
        raise StoreError(f"{folder}: cannot be created ({reason.strerror or reason}): name another folder") from None
    name = plan.campaign.name
    with (folder / f".{name}.lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise StoreError(f"{folder}: another process runs this campaign there: wait for it, or name another --out") from None
        sources = source_version()
        store = Store(
            plan=plan,
            sources=sources,
            final=folder / f"{name}.parquet",
            parts=folder / f".{name}.parts",
            columns=schema(plan, sources),
        )
        if fresh:
            store.final.unlink(missing_ok=True)
            shutil.rmtree(store.parts, ignore_errors=True)
        _check(store)
        yield store


def _check(store: Store) -> None:
    """Refuse rows of something else; write the identity into a folder that is new."""
    required, mark = identity(store.plan, store.sources), store.parts / "identity.json"
    if store.final.exists():
        try:
            _same(known_identity(pq.read_schema(store.final)), required, store.final)
        except pa.ArrowInvalid:
            raise StoreError(f"{store.final}: is no Parquet file: {AGAIN}") from None
        shutil.rmtree(store.parts, ignore_errors=True)  # killed between the file and the end of its parts
        return
    if mark.exists() and any(store.parts.glob(PARTS)):
        _same(json.loads(mark.read_text()), required, store.parts)
    store.parts.mkdir(exist_ok=True)
    _whole(mark, lambda path: _write_text(path, json.dumps(required)))


def _write_text(path: Path, text: str) -> None:
    path.write_text(text)


def _same(found: dict[str, Any], required: dict[str, Any], where: Path) -> None:
    for key, words in _WORDS.items():
        if found.get(key) != required[key]:
            raise StoreError(f"{where}: holds trials of {words} ({key} {found.get(key)}, now {required[key]}): {AGAIN}")
