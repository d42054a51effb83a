"""The four services started by hand in every order: the cell becomes ready and arms, and nothing is started twice.

Example: python bench/orders.py --pause 0.5
"""

import itertools
import sys
import time
from typing import Any

import rig

from experiments.library import find
from services.operator import cell as cells
from services.operator.session import arm, load
from shared.bus import Bus
from shared.topics import SERVICES

EXPERIMENT = "fig-4-25"
PATIENCE_S = 10.0


def comes(bus: Bus, service: str) -> bool:
    """Whether a service answers; the loop does not wait for the recorder, so it may still be starting."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if cells.statuses(bus, (service,)):
            return True
        time.sleep(0.05)
    return False


def trial(place: cells.Place, order: tuple[str, ...], pause_s: float, extra: dict[str, list[str]]) -> dict[str, Any]:
    """Start in that order, load, arm; stop everything."""
    began, started, failure = time.monotonic(), {}, ""
    try:
        for service in order:
            started |= cells.start(place, (service,), with_parent=True, extra=extra)
            time.sleep(pause_s)
        complete = time.monotonic()
        with cells.operator_bus(place) as bus:
            cells.await_ready(place, bus, started)
            load(bus, find(EXPERIMENT), 0, "real")
            arm(bus)
            seconds = time.monotonic() - complete
            present = comes(bus, "recorder")
        dead = [service for service, process in started.items() if process.poll() is not None]
        failure = f"{', '.join(dead)} ended" if dead else "" if present else "the recorder does not answer"
    except cells.CellError as error:
        seconds, failure = time.monotonic() - began, str(error)
    finally:
        cells.stop(process.pid for process in started.values())
    return {"order": order, "armed_s": seconds, "failure": failure}


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--pause", type=float, default=0.5, help="seconds between two starts (0.5)")
    line.add_argument("--permit-ttl-ms", type=float, help="fixed lease: leaves out the two seconds of measuring")
    line.add_argument("--first", type=int, default=24, help="only so many orders (24)")
    given = line.parse_args()
    extra = rig.services_options(permit_ttl_ms=given.permit_ttl_ms)
    results = []
    for order in list(itertools.permutations(SERVICES))[: given.first]:
        with rig.console.status(", ".join(order)):
            results.append(trial(rig.place_of(given), order, given.pause, extra))
        rig.console.print(f"{', '.join(order)}: {results[-1]['failure'] or 'armed'} after {results[-1]['armed_s']:.2f} s")
    times = [result["armed_s"] for result in results if not result["failure"]]
    rows = [(len(results), len(times), rig.percentile(times, 0.5), max(times, default=float("nan")))]
    rig.table("from the last start to armed", ("orders", "armed", "median s", "worst s"), rows)
    rig.finish(given.json, {"pause_s": given.pause, "orders": results})
    return 0 if len(times) == len(results) else 1


if __name__ == "__main__":
    sys.exit(main())
