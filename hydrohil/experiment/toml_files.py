"""Experiments in TOML files. A short one names its `base`, an experiment that ships or another file, and says what differs."""

import os
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from hydrohil.experiment.errors import ExperimentError, unreadable
from hydrohil.experiment.experiment import Experiment, from_plain, to_plain
from hydrohil.experiment.merging import merged, named
from hydrohil.experiment.sections import ControllerConfig, PlantConfig, SupervisorConfig

_OWN = ("name", "alias", "title", "source")  # what a file does not take from its base
_DEEPEST = 8  # files, each the base of the next
_DEFAULTS = {
    "plant": to_plain(PlantConfig()),
    "controller": to_plain(ControllerConfig()),
    "supervisor": to_plain(SupervisorConfig()),
}


def table_of(path: Path) -> dict[str, Any]:
    """What the TOML file at `path` says. Raises ExperimentError with one line where it cannot be read or is no TOML."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))  # editors of Windows begin a file with a byte-order mark
    except (OSError, UnicodeDecodeError) as reason:
        raise unreadable(path, reason) from None
    except (ValueError, RecursionError) as reason:  # ValueError: also an integer of more digits than Python reads
        raise ExperimentError([f"{path}: is no TOML: {reason}; correct the syntax there"]) from None


def from_toml(path: Path, find: Callable[[str], Experiment]) -> Experiment:
    """Read and validate an experiment; `find` gives one that ships, by name.

    What the file leaves out is that of its `base`, or the default; a table such as [plant.machine] keeps the values that it does
    not name, a list is replaced. Raises ExperimentError if a file is missing, no TOML, or not an experiment.
    """
    return _read(path, find, ())


def _read(path: Path, find: Callable[[str], Experiment], above: tuple[Path, ...]) -> Experiment:
    plain = table_of(path)
    base = plain.pop("base", None)
    if base is None:
        under, title = _DEFAULTS, ""
    else:
        found = _base(base, path, find, (*above, _real(path)))
        under = {key: value for key, value in to_plain(found).items() if key not in _OWN}
        title = found.name
    return from_plain(merged(under, named(plain, path, title)), str(path))


def _base(base: Any, path: Path, find: Callable[[str], Experiment], above: tuple[Path, ...]) -> Experiment:
    """The experiment that a file builds on: beside the file where it is one, otherwise one that ships."""
    if not isinstance(base, str):
        expected = 'expected the name of an experiment, or a TOML file; write base = "fig-5-5"'
        raise ExperimentError([f"{path}: base is {base!r}: {expected}"])
    if not base.endswith(".toml"):
        try:
            return find(base)
        except ExperimentError as unknown:
            raise ExperimentError(f"{path}: base: {line}" for line in unknown.problems) from None
    file = path.parent / base
    if _real(file) in above:
        raise ExperimentError([f"{path}: base {base} leads back to this file: name an experiment that stands on its own"])
    if len(above) > _DEEPEST:
        raise ExperimentError([f"{path}: base {base} is more than {_DEEPEST} files deep: name one that stands on its own"])
    return _read(file, find, above)


def _real(path: Path) -> Path:
    """The file that `path` leads to; a link that leads to itself is found when it is read."""
    return Path(os.path.realpath(path))
