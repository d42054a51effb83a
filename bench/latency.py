"""Sample to accepted command in a real run, beside an empty process and a bare transport on the same host.

The baselines run just before and just after, at the same rate and in the same scheduling class: an empty process that
sleeps to an absolute grid, and a ping-pong of frames of the same size between two processes over the same transport.
A second run goes without warm-up frames, to show what they save in latency and cost in processor time.
Example: python bench/latency.py --seconds 60 --rate-hz 222.2
"""

import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import load
import rig

from hydrohil.cell import processes as cells
from hydrohil.cell.connection import service_options
from hydrohil.experiment.sections import latch_substeps
from hydrohil.qualification import probe
from hydrohil.qualification.loop import EXPERIMENT, settings, trial_of
from hydrohil.qualification.spread import spread
from hydrohil.qualification.transport import frame_bytes
from hydrohil.shared.units import NS_PER_S, SUBSTEP_NS

PERCENTILES = ("p50", "p99", "max")


def run(place: cells.Place, given: Any, *, warmups: bool) -> dict[str, Any]:
    """The real run through the command line in a cell of its own: counters of the plant, and processors taken by the cell."""
    options = service_options(realtime=not given.no_realtime)
    options["plant"] += [] if warmups else ["--no-warmup"]
    with rig.running(place, options) as (_, processes), tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        changed = [word for setting in settings(given.seconds, rig.substeps(given.rate_hz)) for word in ("--set", setting)]
        pids = [process.pid for process in processes.values()]
        began, used_s = time.monotonic(), load.processor_s(pids)
        ended = rig.hydrohil("run", EXPERIMENT, *changed, "--json", str(report), place=place)
        taken = (load.processor_s(pids) - used_s) / (time.monotonic() - began)
        if not report.exists():
            raise SystemExit(f"the run did not complete: {ended.stderr.strip()}")
        written: dict[str, Any] = json.loads(report.read_text())
    if written["tripped"] or written["gap"]:
        rig.console.print(f"[red]the run ended early[/]: {written['tripped'] or written['gap']}")
    counters: dict[str, Any] = written["latencies"]
    return counters | {"tripped": written["tripped"], "gap": written["gap"], "processors": taken}


def baselines(given: Any, place: cells.Place, period_ns: int) -> tuple[list[float], list[float]]:
    """Both baselines in processes of their own, so that the scheduling class is theirs alone."""
    settings = probe.Settings(place, period_ns, given.baseline_s, not given.no_realtime)
    return probe.wake_ups(settings)["us"], probe.ping(settings)["us"]


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
    with rig.console.status(f"run of {given.seconds:g} s"):
        counters = run(place, given, warmups=True)
    with rig.console.status(f"run of {given.seconds:g} s without warm-up frames"):
        without = run(place, given, warmups=False)
    with rig.console.status("baselines, after"):
        after = baselines(given, place, period_ns)
    sleep, ping = spread(sleep_us + after[0]), spread(ping_us + after[1])
    return report(given, (counters, without), sleep._asdict(), ping._asdict(), period_ns=period_ns, latch=latch_substeps(plant))


def report(
    given: Any,
    runs: tuple[dict[str, Any], dict[str, Any]],
    sleep_us: dict[str, float],
    ping_us: dict[str, float],
    period_ns: int,
    latch: int,
) -> int:
    """Figures, and each as a ratio to its baseline and to the period."""
    counters, without = runs
    accepted, late, plain = counters["sample_to_accepted_us"], counters["lateness_us"], without["sample_to_accepted_us"]
    rows: list[tuple[object, ...]] = [
        ("sample -> accepted, us", *(accepted[p] for p in PERCENTILES)),
        ("bare ping-pong, us", *(ping_us[p] for p in PERCENTILES)),
        ("  ratio", *(accepted[p] / ping_us[p] for p in PERCENTILES)),
        ("  share of the period", *(accepted[p] * 1000 / period_ns for p in PERCENTILES)),
        ("without warm-up frames, us", *(plain[p] for p in PERCENTILES)),
        ("  ratio", *(plain[p] / ping_us[p] for p in PERCENTILES)),
        ("lateness of the grid, us", *(late[p] for p in PERCENTILES)),
        ("empty process, us", *(sleep_us[p] for p in PERCENTILES)),
        ("  ratio", *(late[p] / sleep_us[p] for p in PERCENTILES)),
    ]
    rig.table(f"{given.seconds:g} s at {NS_PER_S / period_ns:.1f} Hz, latch {latch * 50} us", ("", *PERCENTILES), rows)
    for one, words in ((counters, ""), (without, " without warm-up frames")):
        rig.console.print(
            f"{one['samples']} samples, {one['unanswered']} unanswered at the latch, {one['grid_shifts']} shifts of the grid, "
            f"{one['processors']:.2f} processors{words}"
        )
    figures = {"sleep_us": sleep_us, "ping_us": ping_us, "run": counters, "without_warmup": without, "period_ns": period_ns}
    rig.finish(given.json, figures | {"frame_bytes": frame_bytes(), "seconds": given.seconds, "realtime": not given.no_realtime})
    return 0 if not any(one["tripped"] or one["gap"] for one in runs) else 1


if __name__ == "__main__":
    sys.exit(main())
