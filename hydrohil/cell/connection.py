"""The way into a cell: one that is up, or one that is brought up and ends with its caller."""

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager

from hydrohil.cell import processes as cells
from hydrohil.shared.contract.topics import SERVICES
from hydrohil.shared.transport.bus import Bus

ServiceOptions = Mapping[str, list[str]]  # what each service's command line is given besides the cell's place

_POLL_S = 0.05
_LINKS_S = 0.3  # until the first link to a cell that runs is up
_PARTIAL_S = 1.5  # for the others
_PLANT_S = 1.0  # an operator's request waits so long for the link to the plant
_LOOK_S = 0.2
_LOOK_AGAIN_S = 0.02


def service_options(lease_ms: float | None = None, *, realtime: bool = True) -> dict[str, list[str]]:
    """Options of each service of a cell that is brought up; the lease, in ms, is chosen from the host's lateness if None."""
    common = [] if realtime else ["--no-realtime"]
    lease = [] if lease_ms is None else ["--permit-ttl-ms", str(lease_ms)]
    return {"plant": common + lease, "controller": common, "supervisor": common}


@contextmanager
def attached_cell(place: cells.Place) -> Iterator[Bus]:
    """An operator's bus in a cell that is up, once the plant has answered or a second has passed. Raises CellError."""
    with cells.operator_bus(place) as bus:
        await_plant(bus)
        yield bus


def await_plant(bus: Bus) -> None:
    """Wait until the plant has answered or a second has passed: links come up in the background."""
    deadline = time.monotonic() + _PLANT_S
    while time.monotonic() < deadline and "plant" not in bus.alive(_LOOK_S):
        time.sleep(_LOOK_AGAIN_S)


@contextmanager
def own_cell(place: cells.Place, options: ServiceOptions, services: Sequence[str] = SERVICES) -> Iterator[Bus]:
    """A cell that is brought up here and ends with the `with`, or with this process. Raises CellError, also where one is up."""
    with cells.operator_bus(place) as bus:
        if find_services(bus, place.elsewhere(services)):
            raise cells.CellError(
                f"cell {place.cell!r} is up already: attach to it, stop it (`hydrohil down`), or choose another name and port"
            )
        with _started(place, bus, services, options):
            yield bus


@contextmanager
def found_or_own_cell(place: cells.Place, options: ServiceOptions, services: Sequence[str] = SERVICES) -> Iterator[Bus]:
    """The cell that is up, otherwise one that is brought up here. Raises CellError, also where a part of a cell is up."""
    away = place.elsewhere(services)
    with cells.operator_bus(place) as bus:
        running = find_services(bus, away)
        if running and running != set(cells.LOOP):
            missing = sorted(set(cells.LOOP) - running)
            raise cells.CellError(
                f"the cell has no {' and no '.join(missing)}: start it (`hydrohil {missing[0]}`), or `hydrohil down`"
            )
        if not running and away:
            raise cells.CellError(f"no cell answers, and its {', '.join(away)} run elsewhere: start each on its host first")
        if running:
            cells.await_ready(place, bus)
            yield bus
        else:
            with _started(place, bus, services, options):
                yield bus


@contextmanager
def _started(place: cells.Place, bus: Bus, services: Sequence[str], options: ServiceOptions) -> Iterator[None]:
    """Services that are started, awaited, and stopped at the end."""
    started = cells.start(place, services, with_parent=True, extra=dict(options))
    try:
        cells.await_ready(place, bus, started)
        yield
    finally:
        cells.stop(process.pid for process in started.values())


def find_services(bus: Bus, away: Sequence[str] = (), patience_s: float | None = None) -> set[str]:
    """Services of the loop that are up: links to a cell that runs come up one by one, those to one that ends go so.

    `away` are those on other hosts, for which more time is allowed.
    """
    patience_s = patience_s or (_PARTIAL_S if away else _LINKS_S)
    running: set[str] = set()
    began = time.monotonic()
    while running != set(cells.LOOP) and time.monotonic() - began < (_PARTIAL_S if running else patience_s):
        time.sleep(_POLL_S)
        running = bus.alive() & set(cells.LOOP)
    return running
