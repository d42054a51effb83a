"""A recording read back: every topic as numpy arrays, by the names that the messages have."""

import re
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from hydrohil.shared.contract.file_parts import parts_of
from hydrohil.shared.errors import FileError
from hydrohil.shared.units import NS_PER_S

Reals = npt.NDArray[np.float64]

_TOPICS, _SUMMARY = "/topic/", "/summary"
_SAMPLE, _TRIAL_TIME = "sample", "trial_time"
_PART = re.compile(r"(?P<name>.+)\[\d+\]")


class TopicRecord(Mapping[str, Reals]):
    """Messages of one topic: `record["force_n"]` is (n,), a field of k parts such as `record["q"]` is (n, k).

    `sample` is the number of the plant's sample that each message belongs to, `trial_s` its time in the trial in s, NaN outside
    a trial; (n,) each, in the order of the samples. Whole numbers up to 2**53 are exact.
    """

    def __init__(self, sample: npt.NDArray[np.int64], trial_s: Reals, fields: dict[str, Reals]) -> None:
        """Columns of one topic."""
        self.sample, self.trial_s, self._fields = sample, trial_s, fields

    def __getitem__(self, field: str) -> Reals:
        """A field's values."""
        return self._fields[field]

    def __iter__(self) -> Iterator[str]:
        """Names of the fields."""
        return iter(self._fields)

    def __len__(self) -> int:
        """How many fields."""
        return len(self._fields)

    def __repr__(self) -> str:
        """One line for a notebook."""
        return f"<{len(self.sample)} messages: {', '.join(self)}>"


@dataclass(frozen=True, repr=False)
class Recording:
    """A recording of one run: `recording["controller/state"]["force_n"]`, and so on."""

    path: Path
    topics: dict[str, TopicRecord]
    summary: str  # verdicts, and what is missing of the recording; Markdown

    def __getitem__(self, topic: str) -> TopicRecord:
        """The messages of a topic; KeyError, with the topics that there are, if it has none."""
        if topic not in self.topics:
            raise KeyError(f"{self.path} has no topic {topic!r}: it has {', '.join(self.topics)}")
        return self.topics[topic]

    def __iter__(self) -> Iterator[str]:
        """Names of the topics."""
        return iter(self.topics)

    def __repr__(self) -> str:
        """One line for a notebook."""
        return f"<Recording {self.path}: {', '.join(self.topics)}>"


def read_recording(path: str | Path) -> Recording:
    """Read a `.rrd` file that the recorder wrote; of a long recording, all of its files.

    Raises FileError if it is no recording, OSError if it cannot be read, MissingPackageError without rerun.
    """
    path = Path(path)
    files = parts_of(path) or [path]
    batches: dict[str, list[_Batch]] = {}
    names: dict[str, tuple[str, ...]] = {}
    summary = ""
    for file in files:
        for chunk in _chunks(file):
            entity, table = str(chunk.entity_path), chunk.to_record_batch()
            if entity == _SUMMARY and "TextDocument:text" in table.schema.names:
                summary = table.column("TextDocument:text").to_pylist()[-1][0]
            elif entity.startswith(_TOPICS) and chunk.is_static:
                names[entity.removeprefix(_TOPICS)] = tuple(table.column("SeriesLines:names").to_pylist()[-1])
            elif entity.startswith(_TOPICS):
                batches.setdefault(entity.removeprefix(_TOPICS), []).append(_batch(table))
    if not batches:
        raise FileError(f"{path} is no recording of hydrohil: it has no topics")
    return Recording(path, {topic: _record(batches[topic], names[topic], path) for topic in sorted(batches)}, summary)


class _Batch(NamedTuple):
    sample: npt.NDArray[np.int64]
    trial_s: Reals
    values: Reals


def _chunks(file: Path) -> Iterator[Any]:
    """Every chunk of one file."""
    from rerun.chunk import RrdReader

    with file.open("rb"):  # so that missing rights are reported as for any file
        pass
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a file without a footer was not closed; what it holds is read nevertheless
        try:
            yield from RrdReader(file).stream()
        except (OSError, RuntimeError, ValueError) as reason:
            raise FileError(f"{file} is no recording: {str(reason).splitlines()[0]}") from None


def _batch(table: Any) -> _Batch:
    column = table.column("Scalars:scalars")
    sample = np.asarray(table.column(_SAMPLE).to_numpy(zero_copy_only=False), dtype=np.int64)
    trial_s = np.full(len(sample), np.nan)
    if _TRIAL_TIME in table.schema.names:
        trial_s = table.column(_TRIAL_TIME).cast("int64").to_numpy(zero_copy_only=False) / NS_PER_S
    return _Batch(sample, trial_s, column.flatten().to_numpy(zero_copy_only=False).reshape(len(column), -1))


def _record(batches: list[_Batch], names: tuple[str, ...], path: Path) -> TopicRecord:
    widths = {batch.values.shape[1] for batch in batches}
    if widths != {len(names)}:
        raise FileError(f"{path}: a topic has {sorted(widths)} columns and {len(names)} names: it is of another version")
    sample = np.concatenate([batch.sample for batch in batches])
    order = np.argsort(sample, kind="stable")
    values = np.concatenate([batch.values for batch in batches])[order]
    fields: dict[str, list[int]] = {}
    for number, name in enumerate(names):
        part = _PART.fullmatch(name)
        fields.setdefault(part["name"] if part else name, []).append(number)
    columns = {name: values[:, at[0]] if names[at[0]] == name else values[:, at] for name, at in fields.items()}
    return TopicRecord(sample[order], np.concatenate([batch.trial_s for batch in batches])[order], columns)
