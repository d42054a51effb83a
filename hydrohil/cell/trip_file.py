"""Where the report of a trip is: the recorder's file, or one written here where there is none."""

import sys
import time
from pathlib import Path

from hydrohil.cell import processes as cells
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.trips.files import write
from hydrohil.shared.trips.report import Document

TRIPS = Path("runs/trips")
_PATIENCE_S = 3.0
_POLL_S = 0.1


def kept_file(document: Document, bus: Bus | None) -> str:
    """The recorder's file of this trip; without a recorder, one written here; "" with a line on stderr where that fails."""
    path = _recorded(document, bus) if bus is not None else ""
    if path:
        return path
    try:
        return str(write(TRIPS, document))
    except OSError as error:
        print(f"{TRIPS}: the trip report cannot be written ({error.strerror or error})", file=sys.stderr)
        return ""


def _recorded(document: Document, bus: Bus) -> str:
    """What the recorder's status names, if it is the same trip; the recorder writes it within a second or two."""
    deadline = time.monotonic() + _PATIENCE_S
    while time.monotonic() < deadline and "recorder" in bus.alive():
        trip = cells.statuses(bus, ("recorder",)).get("recorder", {}).get("trip") or {}
        same = (trip.get("run"), trip.get("sample")) == (document["run"], document["sample"])
        if same and (trip["path"] or trip["failure"]):
            return str(trip["path"])
        time.sleep(_POLL_S)
    return ""
