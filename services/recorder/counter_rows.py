"""Counters of a recording: rows that wait until several of one entity make a batch."""

from collections.abc import Callable

import numpy as np

from hydrohil.services.recorder.rows import Rows, equal_runs, times_of
from hydrohil.services.recorder.sample_index import IndexedSample

COUNT_ROWS = 10  # counters come once a second; the recorder's status has the newest count at once


class CounterRows:
    """Rows of counters by entity."""

    def __init__(self, emit: Callable[[Rows], None], count_rows: int) -> None:
        """No row waits; `count_rows` of one entity are written together."""
        self._emit, self._count_rows = emit, count_rows
        self._waiting: dict[str, list[tuple[IndexedSample, tuple[float, ...]]]] = {}

    def add(self, entity: str, sample: IndexedSample, values: tuple[float, ...]) -> None:
        """One row at a sample."""
        rows = self._waiting.setdefault(entity, [])
        rows.append((sample, values))
        if len(rows) >= self._count_rows:
            self._write(entity)

    def flush(self) -> None:
        """Write all rows that wait."""
        for entity in list(self._waiting):
            self._write(entity)

    def _write(self, entity: str) -> None:
        rows = self._waiting.pop(entity)
        for run in equal_runs([sample.trial_time_ns is None for sample, _ in rows]):
            samples, values = zip(*rows[run], strict=True)
            self._emit(Rows(entity, "scalars", times_of(list(samples)), np.array(values, np.float64)))
