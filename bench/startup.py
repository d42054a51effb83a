"""Seconds from `hydrohil up` to an armed cell: with a cold kernel cache, as after an installation, and with a warm one.

Two of the seconds are the plant's measurement of this host, from which it chooses its lease.
Example: python bench/startup.py --trials 5
"""

import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import rig

from hydrohil.cell import processes as cells
from hydrohil.cell.session import arm, load
from hydrohil.qualification.spread import percentile
from hydrohil.thesis.library import find

EXPERIMENT = "fig-4-25"


def trial(place: cells.Place, lease: list[str]) -> dict[str, float]:
    """Up, load, arm, down."""
    began = time.monotonic()
    up = rig.hydrohil("up", *lease, place=place)
    if up.returncode:
        raise SystemExit(f"hydrohil up: {up.stderr.strip()}")
    ready_s = time.monotonic() - began
    try:
        with cells.operator_bus(place) as bus:
            cells.await_ready(place, bus)
            load(bus, find(EXPERIMENT), 0, "real", unqualified=True)
            arm(bus)
            armed_s = time.monotonic() - began
            cells.ask(bus, "supervisor", "stop")
    finally:
        rig.hydrohil("down", place=place)
    return {"ready_s": ready_s, "armed_s": armed_s}


def cache(folder: str) -> list[Path]:
    """Kernels that are cached."""
    return list((Path(folder) / "kernels").rglob("*.nbc"))


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--trials", type=int, default=5, help="cold and warm each (5)")
    line.add_argument("--permit-ttl-ms", help="fixed lease: leaves out the two seconds of measuring")
    given = line.parse_args()
    lease = ["--permit-ttl-ms", given.permit_ttl_ms] if given.permit_ttl_ms else []
    results: list[dict[str, Any]] = []
    for number in range(given.trials):
        with tempfile.TemporaryDirectory() as folder, rig.console.status(f"{number + 1} of {given.trials}"):
            os.environ["HYDROHIL_CACHE"] = folder
            for name in ("cold", "warm"):
                assert bool(cache(folder)) == (name == "warm")
                results.append({"cache": name} | trial(rig.place_of(given), lease))
                rig.console.print(f"{name}: ready {results[-1]['ready_s']:.2f} s, armed {results[-1]['armed_s']:.2f} s")
    rows = []
    for name in ("cold", "warm"):
        armed = [result["armed_s"] for result in results if result["cache"] == name]
        ready = [result["ready_s"] for result in results if result["cache"] == name]
        rows.append((name, len(armed), percentile(ready, 0.5), percentile(armed, 0.5), max(armed)))
    rig.table("from `hydrohil up`", ("cache", "trials", "ready, median s", "armed, median s", "armed, worst s"), rows)
    rig.finish(given.json, {"trials": results})
    return 0


if __name__ == "__main__":
    sys.exit(main())
