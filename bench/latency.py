"""Sample to accepted command in a real run, and beside it what this host gives an empty process and a bare transport.

The baselines run just before and just after the run, at the same rate and in the same scheduling class: an empty process
that sleeps to an absolute grid, and a ping-pong of frames of the same size between two processes over the same transport.
Example: python bench/latency.py --seconds 60 --rate-hz 222.2
"""

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

import rig

from qualification import probe
from qualification.loop import EXPERIMENT, settings, trial_of
from qualification.spread import spread
from qualification.transport import frame_bytes
from services.operator import cell as cells
from services.plant.config import latch_substeps
from shared.units import NS_PER_S, SUBSTEP_NS

PERCENTILES = ("p50", "p99", "max")


def run(place: cells.Place, given: Any) -> dict[str, Any]:
    """The real run through the command line: counters of the plant."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        changed = [word for setting in settings(given.seconds, rig.substeps(given.rate_hz)) for word in ("--set", setting)]
        ended = rig.hydrohil("run", EXPERIMENT, *changed, "--json", str(report), place=place)
        if not report.exists():
            raise SystemExit(f"the run did not complete: {ended.stderr.strip()}")
        made: dict[str, Any] = json.loads(report.read_text())
    if made["tripped"] or made["gap"]:
        rig.console.print(f"[red]the run ended early[/]: {made['tripped'] or made['gap']}")
    counters: dict[str, Any] = made["latencies"]
    return counters | {"tripped": made["tripped"], "gap": made["gap"]}


def baselines(given: Any, place: cells.Place, period_ns: int) -> tuple[list[float], list[float]]:
    """Both baselines in processes of their own, so that the scheduling class is theirs alone."""
    asked = probe.Asked(place, period_ns, given.baseline_s, not given.no_realtime)
    return probe.wake_ups(asked)["us"], probe.ping(asked)["us"]


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--seconds", type=float, default=60.0, help="of the run (60)")
    line.add_argument("--rate-hz", type=float, default=222.2, help="sampling rate (222.2)")
    line.add_argument("--baseline-s", type=float, default=10.0, help="of each baseline, before and after (10)")
    line.add_argument("--no-realtime", action="store_true", help="normal scheduling")
    given = line.parse_args()
    plant = trial_of(given.seconds, rig.substeps(given.rate_hz)).plant
    period_ns = plant.sample_period_substeps * SUBSTEP_NS
    place = rig.place_of(given)
    with rig.console.status("baselines, before"):
        sleep_us, ping_us = baselines(given, place, period_ns)
    with (
        rig.running(place, rig.services_options(realtime=not given.no_realtime)),
        rig.console.status(f"run of {given.seconds:g} s"),
    ):
        counters = run(place, given)
    with rig.console.status("baselines, after"):
        after = baselines(given, place, period_ns)
    sleep, ping = spread(sleep_us + after[0]), spread(ping_us + after[1])
    return report(given, counters, sleep._asdict(), ping._asdict(), period_ns, latch_substeps(plant))


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
