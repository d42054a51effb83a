"""A long trial in a live cell, recorder included: samples missed, memory of every process, trips.

Memory is the resident size in /proc, read every few seconds; growth is the slope of a straight line through the second
half, when every buffer has been filled once. Example: python bench/soak.py --minutes 20 --rate-hz 500
"""

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import rig
from load import begin

from hydrohil.cell import processes as cells
from hydrohil.cell.connection import service_options
from hydrohil.experiment.experiment import Experiment
from hydrohil.qualification.loop import trial_of
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_TRIAL, Mode
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.units import SUBSTEP_S

RING = 1 << 14  # frames between two looks
LOOK_S = 0.5
READ_S = 5.0
SILENT_S = 5.0  # without a sample the soak is over
BYTES_PER_MB = 1 << 20
BYTES_PER_KB = 1 << 10


def resident_bytes(pid: int) -> int:
    """Memory of a process that is in RAM; 0 if it has ended."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) * BYTES_PER_KB for line in lines if line.startswith("VmRSS")), 0)


def soak(bus: Bus, processes: cells.Processes, experiment: Experiment) -> dict[str, Any]:
    """Watch one trial to its end."""
    samples, permits = bus.subscribe("plant/sample", RING), bus.subscribe("supervisor/permit", RING)
    begin(bus, experiment, "real")
    memory: dict[str, list[tuple[float, int]]] = {name: [] for name in processes}
    began = last_arrival = time.monotonic()
    read, count, tick, tripped = 0.0, 0, 0, False
    with rig.console.status("") as status:
        while not tripped and time.monotonic() - last_arrival < SILENT_S:
            time.sleep(LOOK_S)
            now = time.monotonic() - began
            taken = samples.take()
            last_arrival = time.monotonic() if taken else last_arrival
            ticks = [m.body.tick for m in taken if m.body.tick != NO_TRIAL]
            ended = count > 0 and taken != [] and taken[-1].body.tick == NO_TRIAL
            count += len(ticks)
            tick = ticks[-1] if ticks else tick
            permit = permits.peek()
            tripped = isinstance(permit, Received) and permit.body.mode == Mode.TRIPPED
            if now - read >= READ_S:
                read = now
                for name, process in processes.items():
                    memory[name].append((now, resident_bytes(process.pid)))
                status.update(f"{now:.0f} of {experiment.duration_s:g} s, {count} samples")
            if ended:
                break
    return {
        "memory": memory,
        "samples": count,
        "last_tick": tick,
        "lost_at_observer": samples.acceptance.lost,
        "tripped": tripped,
    }


def growth(readings: list[tuple[float, int]]) -> dict[str, float]:
    """First and last reading in MB, and the slope of the second half in MB an hour."""
    at_s, size = np.array(readings, dtype=np.float64).T
    half = slice(len(at_s) // 2, None)
    slope = float(np.polyfit(at_s[half], size[half], 1)[0]) if len(at_s[half]) > 1 else float("nan")
    return {
        "first_mb": float(size[0]) / BYTES_PER_MB,
        "last_mb": float(size[-1]) / BYTES_PER_MB,
        "mb_per_hour": slope * 3600.0 / BYTES_PER_MB,
    }


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--minutes", type=float, default=20.0, help="of the trial (20)")
    line.add_argument("--rate-hz", type=float, default=500.0, help="sampling rate (500)")
    line.add_argument("--permit-ttl-ms", type=float, help="lease (chosen by the plant)")
    line.add_argument("--no-realtime", action="store_true", help="normal scheduling")
    given = line.parse_args()
    experiment, place = trial_of(given.minutes * 60.0, rig.substeps(given.rate_hz)), rig.place_of(given)
    extra = service_options(realtime=not given.no_realtime, lease_ms=given.permit_ttl_ms)
    with tempfile.TemporaryDirectory() as folder, rig.running(place, extra) as (bus, processes):
        file = Path(folder) / "soak.rrd"
        cells.ask(bus, "recorder", "record", 10.0, path=str(file), title="soak", summary_markdown="# soak")
        result = soak(bus, processes, experiment)
        found = cells.statuses(bus)
        recorded = cells.ask(bus, "recorder", "finish", 60.0, summary_markdown="# soak")
        result |= {"counters": found["plant"]["counters"], "lease_ms": found["plant"]["lease_ms"]}
        result |= {"words": found["supervisor"]["words"], "gaps": recorded["gaps"], "file_mb": recorded["bytes"] / BYTES_PER_MB}
    return report(given, experiment, result)


def report(given: Any, experiment: Experiment, result: dict[str, Any]) -> int:
    """Figures; 0 if the trial came to its end."""
    memory = {name: growth(readings) for name, readings in result["memory"].items() if readings}
    rows = [(name, *(round(value, 2) for value in figures.values())) for name, figures in memory.items()]
    rig.table("resident memory", ("process", "first MB", "last MB", "second half, MB an hour"), rows)
    counters = result["counters"]
    share = counters["unanswered"] / max(1, counters["samples"])
    rig.console.print(
        f"{counters['samples']} samples, {counters['unanswered']} unanswered at the latch ({share:.3%}), "
        f"{counters['grid_shifts']} shifts of the grid, lease {result['lease_ms']} ms, "
        f"{result['lost_at_observer']} lost on the way to the observer, {result['gaps']} gaps in the recording "
        f"({result['file_mb']:.1f} MB); tripped: {result['words'] if result['tripped'] else 'no'}"
    )
    rig.finish(given.json, result | {"memory": memory, "minutes": given.minutes, "rate_hz": given.rate_hz})
    complete = result["last_tick"] >= round(experiment.duration_s / (experiment.plant.sample_period_substeps * SUBSTEP_S)) - 1
    return 0 if complete and not result["tripped"] else 1


if __name__ == "__main__":
    sys.exit(main())
