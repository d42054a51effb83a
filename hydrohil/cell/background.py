"""A cell that outlives its starter: what `hydrohil up` starts and `hydrohil down` stops."""

from collections.abc import Mapping, Sequence
from typing import Any

from hydrohil.cell import processes as cells

_ORDER = ("controller", "supervisor", "plant", "recorder")  # the valves go to zero first


def bring_up(place: cells.Place, services: Sequence[str], options: Mapping[str, list[str]]) -> dict[str, dict[str, Any]]:
    """Start `services` in the background; returns each service's status when all are ready. Raises CellError."""
    started = cells.start(place, services, with_parent=False, extra=dict(options))
    cells.remember(place, started)
    try:
        with cells.operator_bus(place) as bus:
            return cells.await_ready(place, bus, started)
    except BaseException:
        cells.stop(process.pid for process in started.values())
        raise


def take_down(place: cells.Place) -> bool:
    """Stop what `bring_up` started on this machine; False if there is nothing of it."""
    pids = cells.remembered(place)
    cells.stop(pids[service] for service in _ORDER if service in pids)
    if pids:
        (place.folder / "cell.json").unlink(missing_ok=True)
    return bool(pids)
