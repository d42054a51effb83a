"""Sample to accepted command in a real run, and beside it what this host gives an empty process and a bare transport.

The baselines run just before and just after the run, at the same rate and in the same scheduling class: an empty process
that sleeps to an absolute grid, and a ping-pong of frames of the same size between two processes over the same transport.
Example: python bench/latency.py --seconds 60 --rate-hz 222.2
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import rig

from experiments.library import find
from experiments.overrides import with_overrides
from services.operator import cell as cells
from services.plant.config import latch_substeps
from shared.bus import Bus
from shared.clock import sleep_until
from shared.codec import Header, encode
from shared.messages import Sample
from shared.realtime import claim
from shared.units import NS_PER_S, SUBSTEP_S

EXPERIMENT = "fig-4-25"
WARM_UP = 50
PERCENTILES = ("p50", "p99", "max")


def settings(seconds: float, rate_hz: float) -> list[str]:
    """The sine for as long as wanted, at the wanted rate."""
    period = round(1.0 / (rate_hz * SUBSTEP_S))
    return [
        f"duration_s={float(seconds)}",
        f"reference.0.duration_s={float(seconds)}",
        "reference.0.amount_end=0.0",
        "claims=[]",
        f"plant.sample_period_substeps={period}",
        "plant.jitter_substeps=0",
    ]


def run(place: cells.Place, given: Any) -> dict[str, Any]:
    """The real run through the command line: counters of the plant."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        changed = [word for setting in settings(given.seconds, given.rate_hz) for word in ("--set", setting)]
        ended = rig.hydrohil("run", EXPERIMENT, *changed, "--json", str(report), place=place)
        if not report.exists():
            raise SystemExit(f"the run did not complete: {ended.stderr.strip()}")
        made: dict[str, Any] = json.loads(report.read_text())
    if made["tripped"] or made["gap"]:
        rig.console.print(f"[red]the run ended early[/]: {made['tripped'] or made['gap']}")
    counters: dict[str, Any] = made["latencies"]
    return counters | {"tripped": made["tripped"], "gap": made["gap"]}


def sleeper(period_ns: int, seconds: float) -> list[float]:
    """Lateness in us of a process that does nothing but sleep to an absolute grid."""
    late, due = [], time.monotonic_ns()
    for _ in range(int(seconds * NS_PER_S / period_ns)):
        due += period_ns
        late_ns = sleep_until(due)
        late.append(late_ns / 1000)
        due += late_ns if late_ns > period_ns else 0
    return late


def frame_bytes() -> int:
    """Size of a sample's frame."""
    header = Header(1, 1, "cell", 1 << 47, bytes(32), "plant", 1 << 61, 1 << 61, 1 << 20, 1 << 20, 1 << 40)
    sample = Sample(1 << 20, 1 << 40, 1000, 1 << 40, (4000,) * 5, 100, (2048,) * 3, 1, 0, 1000, (0, 0, 0), 1 << 20, 0, 1 << 22)
    return len(encode("hydrohil/cell/plant/sample", header, sample))


def ping(place: cells.Place, period_ns: int, seconds: float, *, realtime: bool) -> list[float]:
    """Round trips in us of a bare frame to an echoing process, once a period."""
    options = [] if realtime else ["--no-realtime"]
    line = [sys.executable, __file__, "--echo", place.cell, "--port", str(place.port), *options]
    echoing = subprocess.Popen(line)
    key, back, payload, taken = f"ping/{place.cell}", f"pong/{place.cell}", bytes(frame_bytes()), []
    try:
        with Bus("controller", place.cell, place.port, 1) as bus:
            arrived: list[int] = []

            def stamp(_sample: Any) -> None:
                arrived.append(time.monotonic_ns())
                bus.wake()

            kept = bus._session.declare_subscriber(back, stamp_handler(stamp))
            due = time.monotonic_ns()
            for _ in range(int(seconds * NS_PER_S / period_ns) + WARM_UP):
                due = max(due + period_ns, time.monotonic_ns())
                sleep_until(due)
                arrived.clear()
                sent = time.monotonic_ns()
                bus._session.put(key, payload)
                bus.wait(0.2)
                if arrived:
                    taken.append((arrived[0] - sent) / 1000)
            del kept
    finally:
        echoing.terminate()
        echoing.wait()
    return taken[WARM_UP:]


def stamp_handler(callback: Any) -> Any:
    """A callback as the services use it."""
    import zenoh

    return zenoh.handlers.Callback(callback, indirect=False)


def echo(cell: str, port: int, *, realtime: bool) -> int:
    """The other process: wake, answer, sleep."""
    claim(realtime=realtime)
    with Bus("plant", cell, port, 1) as bus:
        frames: list[bytes] = []

        def take(sample: Any) -> None:
            frames.append(sample.payload.to_bytes())
            bus.wake()

        kept = bus._session.declare_subscriber(f"ping/{cell}", stamp_handler(take))
        while os.getppid() != 1:
            bus.wait(0.5)
            while frames:
                bus._session.put(f"pong/{cell}", frames.pop(0))
        del kept
    return 0


def baselines(given: Any, period_ns: int) -> tuple[list[float], list[float]]:
    """Both baselines in a process of their own, so that the scheduling class is theirs alone."""
    options = ["--no-realtime"] if given.no_realtime else []
    line = [sys.executable, __file__, "--baseline", "--seconds", str(given.baseline_s), "--rate-hz", str(given.rate_hz), *options]
    measured = json.loads(subprocess.run(line, capture_output=True, text=True, check=True).stdout)
    return measured["sleep_us"], measured["ping_us"]


def baseline(given: Any, period_ns: int) -> int:
    """What `baselines` runs."""
    place = rig.place_of(given)
    claim(realtime=not given.no_realtime)
    sleep_us = sleeper(period_ns, given.seconds)
    print(json.dumps({"sleep_us": sleep_us, "ping_us": ping(place, period_ns, given.seconds, realtime=not given.no_realtime)}))
    return 0


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--seconds", type=float, default=60.0, help="of the run (60)")
    line.add_argument("--rate-hz", type=float, default=222.2, help="sampling rate (222.2)")
    line.add_argument("--baseline-s", type=float, default=10.0, help="of each baseline, before and after (10)")
    line.add_argument("--no-realtime", action="store_true", help="normal scheduling")
    line.add_argument("--baseline", action="store_true", help="measure the baselines alone and print them as JSON")
    line.add_argument("--echo", metavar="CELL", help="be the other end of the ping-pong")
    given = line.parse_args()
    if given.echo:
        return echo(given.echo, given.port, realtime=not given.no_realtime)
    plant = with_overrides(find(EXPERIMENT), settings(given.seconds, given.rate_hz)).plant
    period_ns = round(plant.sample_period_substeps * SUBSTEP_S * NS_PER_S)
    if given.baseline:
        return baseline(given, period_ns)
    place = rig.place_of(given)
    with rig.console.status("baselines, before"):
        sleep_us, ping_us = baselines(given, period_ns)
    with (
        rig.running(place, rig.services_options(realtime=not given.no_realtime)),
        rig.console.status(f"run of {given.seconds:g} s"),
    ):
        counters = run(place, given)
    with rig.console.status("baselines, after"):
        after = baselines(given, period_ns)
    return report(
        given, counters, rig.spread(sleep_us + after[0]), rig.spread(ping_us + after[1]), period_ns, latch_substeps(plant)
    )


def report(
    given: Any, counters: dict[str, Any], sleep_us: dict[str, float], ping_us: dict[str, float], period_ns: int, latch: int
) -> int:
    """Figures, and each as a ratio to its baseline and to the period."""
    accepted, late = counters["sample_to_accepted_us"], counters["lateness_us"]
    rows: list[tuple[object, ...]] = [
        ("sample -> accepted, us", *(accepted[p] for p in PERCENTILES)),
        ("bare ping-pong, us", *(ping_us[p] for p in PERCENTILES)),
        ("  ratio", *(accepted[p] / ping_us[p] for p in PERCENTILES)),
        ("  share of the period", *(accepted[p] * 1000 / period_ns for p in PERCENTILES)),
        ("lateness of the grid, us", *(late[p] for p in PERCENTILES)),
        ("empty process, us", *(sleep_us[p] for p in PERCENTILES)),
        ("  ratio", *(late[p] / sleep_us[p] for p in PERCENTILES)),
    ]
    rig.table(f"{given.seconds:g} s at {NS_PER_S / period_ns:.1f} Hz, latch {latch * 50} us", ("", *PERCENTILES), rows)
    samples, missed = counters["samples"], counters["unanswered"]
    rig.console.print(f"{samples} samples, {missed} unanswered at the latch, {counters['grid_shifts']} shifts of the grid")
    figures = {"sleep_us": sleep_us, "ping_us": ping_us, "run": counters, "frame_bytes": frame_bytes(), "period_ns": period_ns}
    rig.finish(given.json, figures | {"seconds": given.seconds, "realtime": not given.no_realtime})
    return 0 if not counters["tripped"] and not counters["gap"] else 1


if __name__ == "__main__":
    sys.exit(main())
