"""What the recorder writes: rows of one entity with their times. Numbers and text only, no rerun."""

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hydrohil.services.recorder.sample_index import IndexedSample

Kind = Literal["scalars", "names", "state", "text", "joint", "points", "arrows", "document"]


class Times(NamedTuple):
    """Sample number of each row, and its time in the trial; rows in and out of a trial never share a batch."""

    samples: NDArray[np.int64]
    trial_ns: NDArray[np.int64] | None


class Rows(NamedTuple):
    """Rows for one entity; `times` None = holds for the whole recording.

    values: scalars (n, k); names k texts; state n texts; text n (level, text); joint (n,); points (n, 3);
    arrows (n, 2, 3) origin and vector; document one text in Markdown.
    """

    entity: str
    kind: Kind
    times: Times | None
    values: Any


def times_of(samples: list[IndexedSample]) -> Times:
    """Times of rows that all lie in a trial, or all outside."""
    numbers = np.array([sample.number for sample in samples], np.int64)
    if not samples or samples[0].trial_time_ns is None:
        return Times(numbers, None)
    return Times(numbers, np.array([sample.trial_time_ns for sample in samples], np.int64))


def selected(times: Times, kept: NDArray[Any]) -> Times:
    """The times of some of the rows; `kept` is a mask or indices."""
    return Times(times.samples[kept], None if times.trial_ns is None else times.trial_ns[kept])


def equal_runs(keys: list[Any]) -> list[slice]:
    """Runs of equal neighbours."""
    if not keys:
        return []
    ends = [i for i in range(1, len(keys)) if keys[i] != keys[i - 1]] + [len(keys)]
    return [slice(start, end) for start, end in zip([0, *ends], ends, strict=False)]
