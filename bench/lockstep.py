"""Speed of a lockstep run beside the transport's limit, and the processor time of each process.

The limit: bare round trips of frames of the same size between two processes, back to back, before and after the run. A cell
makes one such round trip a sample and computes besides; the processor time a sample shows in which process.
Example: python bench/lockstep.py --seconds 60
"""

import sys
import time
from typing import Any

import load
import rig

from hydrohil.cell import processes as cells
from hydrohil.cell.connection import service_options
from hydrohil.qualification.loop import trial_of
from hydrohil.qualification.probe import Settings, ping
from hydrohil.shared.transport.bus import Bus

HURRIED_NS, PINGED_S = 50_000, 0.25  # shorter than any round trip; 5000 of them
RING = 1 << 15


def limit_per_s(given: Any) -> float:
    """Bare round trips a second, in the scheduling class of lockstep; one begins when the one before has ended."""
    taken_us = ping(Settings(rig.place_of(given), HURRIED_NS, PINGED_S, False))["us"]
    return 1e6 * len(taken_us) / sum(taken_us)


def trial(bus: Bus, processes: cells.Processes, given: Any) -> dict[str, Any]:
    """One run in lockstep: samples a second of wall time, and processor time a sample by process."""
    samples = bus.subscribe("plant/sample", RING)
    load.begin(bus, trial_of(given.seconds, rig.substeps(given.rate_hz)), "lockstep")
    samples.take()
    began, used = time.monotonic(), {name: load.processor_s([process.pid]) for name, process in processes.items()}
    first = last = -1
    while load.goes_on(bus):
        numbers = [message.body.number for message in samples.take()]
        if numbers:
            first, last = (numbers[0] if first < 0 else first), numbers[-1]
            ended = time.monotonic()
    count = last - first
    spent = {name: (load.processor_s([process.pid]) - used[name]) / count for name, process in processes.items()}
    rate = count / (ended - began)
    return {"samples": count, "samples_per_s": rate, "times_real_time": rate / given.rate_hz, "processor_s_a_sample": spent}


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--seconds", type=float, default=60.0, help="simulated, of the run (60)")
    line.add_argument("--rate-hz", type=float, default=222.2, help="sampling rate (222.2)")
    given = line.parse_args()
    with rig.console.status("bare round trips, before"):
        before = limit_per_s(given)
    with (
        rig.running(rig.place_of(given), service_options(lease_ms=150.0)) as (bus, processes),
        rig.console.status(f"lockstep, {given.seconds:g} simulated seconds"),
    ):
        found = trial(bus, processes, given)
    with rig.console.status("bare round trips, after"):
        limit = (before + limit_per_s(given)) / 2.0
    found |= {"limit_per_s": limit, "of_the_limit": found["samples_per_s"] / limit}
    rows = [(name, found[name]) for name in ("samples_per_s", "times_real_time", "limit_per_s", "of_the_limit")]
    rows += [(f"{name}, us of processor a sample", 1e6 * spent) for name, spent in found["processor_s_a_sample"].items()]
    rig.table(f"lockstep at {given.rate_hz:g} Hz, supervisor and recorder included", ("figure", "value"), rows)
    rig.finish(given.json, found | {"rate_hz": given.rate_hz})
    return 0


if __name__ == "__main__":
    sys.exit(main())
