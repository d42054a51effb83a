"""Whether a recording on disk is whole: closed with its footer, and how much is in it."""

import warnings
from pathlib import Path

from rerun.chunk import RrdReader


def chunks_of(path: Path) -> int:
    """How many chunks a closed recording holds; raises ValueError if it cannot be read or was not closed."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a missing footer is a warning
        try:
            return sum(1 for _ in RrdReader(path).stream())
        except (OSError, RuntimeError, ValueError, Warning) as reason:
            raise ValueError(f"{path}: {reason}") from None
