"""The cost of a cell against the number of cells on one host: processor time, latency, answers missed, and the most that run.

All cells run the same motion at the same time, recorder included. Example: python bench/cells.py --cells 1 2 4 8 --rate-hz 222.2
"""

import os
import sys
import time
from contextlib import ExitStack
from typing import Any

import load
import rig

from hydrohil.cell import processes as cells
from hydrohil.cell.connection import service_options
from hydrohil.qualification.loop import trial_of

COLUMNS = ("cells", "cores used", "cores a cell", "p50, us", "p99, us", "unanswered", "tripped")


def trial(count: int, given: Any) -> dict[str, Any]:
    """So many cells, each with a trial of its own at the same time."""
    experiment = trial_of(given.seconds, rig.substeps(given.rate_hz))
    extra = service_options(realtime=not given.no_realtime, lease_ms=given.permit_ttl_ms)
    with ExitStack() as stack:
        rigs = [stack.enter_context(rig.running(place, extra)) for place in places(count, given)]
        pids = [process.pid for _, processes in rigs for process in processes.values()]
        for bus, _ in rigs:
            load.begin(bus, experiment, "real")
        began, used_s = time.monotonic(), load.processor_s(pids)
        while time.monotonic() - began < given.seconds:
            time.sleep(load.TICK_S)
        cores = (load.processor_s(pids) - used_s) / (time.monotonic() - began)
        found = [cells.statuses(bus, cells.LOOP, timeout_s=3.0) for bus, _ in rigs]
    return summary(count, cores, found)


def places(count: int, given: Any) -> list[cells.Place]:
    """Names and ports, each cell its own."""
    first = rig.place_of(given)
    return [first._replace(cell=f"{first.cell}-{number}", port=first.port + 4 * number) for number in range(count)]


def summary(count: int, cores: float, found: list[dict[str, dict[str, Any]]]) -> dict[str, Any]:
    """Of all cells: cores, the worst cell's percentiles, answers missed, cells tripped; one that is silent counts as tripped."""
    counters = [cell["plant"]["counters"] for cell in found if "plant" in cell]
    latencies = [one["sample_to_accepted_us"] for one in counters if one["sample_to_accepted_us"]]
    samples = sum(one["samples"] for one in counters)
    return {
        "cells": count,
        "cores": cores,
        "cores_a_cell": cores / count,
        "p50_us": max((one["p50"] for one in latencies), default=float("nan")),
        "p99_us": max((one["p99"] for one in latencies), default=float("nan")),
        "unanswered": sum(one["unanswered"] for one in counters) / samples if samples else float("nan"),
        "tripped": sum(cell.get("supervisor", {}).get("mode", "TRIPPED") == "TRIPPED" for cell in found),
    }


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--cells", type=int, nargs="+", default=[1, 2, 4, 8], help="numbers of cells to try (1 2 4 8)")
    line.add_argument("--seconds", type=float, default=20.0, help="of each (20)")
    line.add_argument("--rate-hz", type=float, default=222.2, help="sampling rate (222.2)")
    line.add_argument("--permit-ttl-ms", type=float, default=200.0, help="lease (200: a cell that is late is counted, not cut)")
    line.add_argument("--no-realtime", action="store_true", help="normal scheduling")
    given = line.parse_args()
    results = []
    for count in given.cells:
        with rig.console.status(f"{count} cells"):
            try:
                results.append(trial(count, given))
            except cells.CellError as error:  # more cells than this do not run here
                rig.console.print(f"{count} cells: {error}")
                break
    rows = [(*list(result.values())[:5], f"{result['unanswered']:.2%}", result["tripped"]) for result in results]
    rig.table(f"cells at {given.rate_hz:g} Hz on {os.cpu_count()} cores, worst cell", COLUMNS, rows)
    rig.finish(given.json, {"rate_hz": given.rate_hz, "seconds": given.seconds, "cells": results})
    return 0


if __name__ == "__main__":
    sys.exit(main())
