"""Start orders and restarts (row 29): the cell becomes ready and arms in any order; no current before."""

import itertools
import time
from random import Random

from hydrohil.cell import processes as cells
from hydrohil.cell.session import arm, load
from hydrohil.faulttest.motions import SWING
from hydrohil.faulttest.observer import Observer, safe
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.contract.topics import SERVICES
from hydrohil.shared.transport.bus import Bus

ORDERS = tuple(itertools.permutations(SERVICES))
PAUSE_S = 0.3  # between two starts, at most: a service then waits for the next
PATIENCE_S = 10.0
PORTS = 4  # of the fault test's own cell; this cell uses those behind them


def in_start_order(rig: Rig, rng: Random, number: int) -> Trial:
    """The four services by hand, in one of the 24 orders; every order comes once before one comes again."""
    order = Random(str(rig.place.cell)).sample(ORDERS, len(ORDERS))[number % len(ORDERS)]
    place = rig.place._replace(cell=f"{rig.place.cell}-orders", port=rig.place.port + PORTS)
    started: cells.Processes = {}
    try:
        for service in order:
            started |= cells.start(place, (service,), with_parent=True, extra=rig.extra)
            time.sleep(rng.uniform(0.0, PAUSE_S))
        return _armed(place, started, order)
    finally:
        cells.stop(process.pid for process in started.values())


def _armed(place: cells.Place, started: cells.Processes, order: tuple[str, ...]) -> Trial:
    last_start_s = time.monotonic()
    with cells.operator_bus(place) as bus:
        observer = Observer(bus)
        cells.await_ready(place, bus, started)
        load(bus, SWING, 0, "real", unqualified=True)
        arm(bus)
        elapsed_s = time.monotonic() - last_start_s
        observed = observer.listen()
        present = _answers(bus, "recorder")
    unsafe = sum(not safe(sample) for sample in observed.samples)
    dead = [service for service, process in started.items() if process.poll() is not None]
    words = f"{', '.join(order)}: armed {elapsed_s:.2f} s after the last start, {unsafe} samples with current before"
    words += "" if present else "; the recorder does not answer"
    return Trial(not dead and present and unsafe == 0, words + (f"; {', '.join(dead)} ended" if dead else ""), elapsed_s)


def _answers(bus: Bus, service: str) -> bool:
    """Whether a service answers in time; the loop does not wait for the recorder, so it may still be starting."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if cells.statuses(bus, (service,)):
            return True
        time.sleep(0.05)
    return False


def rejoined(rig: Rig, rng: Random, number: int) -> Trial:
    """One service ends and starts anew in a cell at rest: no current, and the cell arms again."""
    service = SERVICES[number % len(SERVICES)]
    rig.reset()
    rig.observer.clear()
    rig.processes[service].terminate()
    rig.processes[service].wait()
    time.sleep(rng.uniform(0.0, PAUSE_S))
    rig.restart_ended()
    load(rig.bus, SWING, 0, "real", unqualified=True)
    arm(rig.bus)
    present = _answers(rig.bus, service)
    unsafe = sum(not safe(sample) for sample in rig.observer.listen().samples)
    return Trial(present and unsafe == 0, f"{service} started anew: armed again, {unsafe} samples with current")
