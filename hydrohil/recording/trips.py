"""Trip reports: why and how the rig tripped, with the last 10 s of all signals."""

from pathlib import Path
from typing import Any

from hydrohil.shared.errors import FileError
from hydrohil.shared.trips import files

TRIPS = Path("runs/trips")  # a recorder's folder, and the command line's


def read_trip(path: str | Path | None = None) -> dict[str, Any]:
    """Read a trip report; without a path the newest in `runs/trips`.

    Its `sentence` says why in words; `cause`, `measured`, `limit` and `sample` are the rule's; `ages` and `counters` show who was
    late; `signals` holds the messages of each topic as lists by field (`signals["plant/sample"]["force_counts"]`), None where a
    number is unknown.
    Raises FileError if it is no trip report, or if there is none; OSError if it cannot be read.
    """
    path = newest_trip_file() if path is None else Path(path)
    try:
        return files.read(path)
    except UnicodeDecodeError:
        raise FileError(f"{path} is no trip report: it is no text") from None
    except ValueError as refused:
        raise FileError(str(refused)) from None


def newest_trip_file(folder: str | Path = TRIPS) -> Path:
    """The newest trip report in `folder`. Raises FileError if there is none."""
    found = files.reports(Path(folder))
    if not found:
        raise FileError(f"no trip report in {folder}: `hydrohil status` names the last one of a cell that runs")
    return found[-1]


def write_trip(report: dict[str, Any], folder: str | Path = TRIPS) -> Path:
    """Write a trip report, such as `run.trip_report`, under a name of its own in `folder`; returns the file. Raises OSError."""
    return files.write(Path(folder), report)
