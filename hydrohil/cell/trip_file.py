"""Where the recorder has written the report of a trip."""

import time

from hydrohil.cell.processes import statuses
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.trips.report import Document

_PATIENCE_S = 3.0
_POLL_S = 0.1


def recorded_file(document: Document, bus: Bus) -> str:
    """The recorder's file of this trip, which it writes within a second or two; "" without a recorder, or where it failed."""
    deadline = time.monotonic() + _PATIENCE_S
    while time.monotonic() < deadline and "recorder" in bus.alive():
        trip = statuses(bus, ("recorder",)).get("recorder", {}).get("trip") or {}
        same = (trip.get("run"), trip.get("sample")) == (document["run"], document["sample"])
        if same and (trip["path"] or trip["failure"]):
            return str(trip["path"])
        time.sleep(_POLL_S)
    return ""
