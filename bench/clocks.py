"""One experiment on the three clocks: are the traces equal bit for bit, and was lateness the reason where they are not?

A real run is clean when no command and no permit was late or missing. Every clean run, and every lockstep run, must equal
the local one; every other must equal it up to the first sample whose command was late.

Example: python bench/clocks.py --runs 10 --json clocks.json
"""

import json
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import rig

from hydrohil.cell.connection import service_options
from hydrohil.claims.trace import Trace
from hydrohil.claims.trace_files import read_trace
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.overrides import with_overrides
from hydrohil.simulation.rollout import rollout
from hydrohil.thesis.library import find

WALL_CLOCK_FIELDS = ("sample_age_s",)  # ages on the wall clock: the only columns that may differ
FAULTS = ("late_commands", "unanswered", "late_permits")


class Difference(NamedTuple):
    """The first field, in time, that is not the same."""

    tick: int
    field: str
    here: str
    local: str


def first_difference(trace: Trace, local: Trace) -> Difference | None:
    """Where `trace` first departs from `local`, bit for bit; None if nowhere."""
    if len(trace.tick) != len(local.tick):
        return Difference(min(len(trace.tick), len(local.tick)), "length", str(len(trace.tick)), str(len(local.tick)))
    found = []
    for field in Trace._fields:
        here, there = getattr(trace, field), getattr(local, field)
        if field in WALL_CLOCK_FIELDS:
            continue
        if here.dtype != there.dtype or here.shape != there.shape:
            return Difference(0, field, f"{here.dtype}{here.shape}", f"{there.dtype}{there.shape}")
        bits = (here.view(np.int64) != there.view(np.int64)).reshape(len(here), -1).any(axis=1)
        if bits.any():
            row = int(bits.argmax())
            found.append(Difference(int(local.tick[row]), field, str(here[row]), str(there[row])))
    return min(found, default=None)


def trial(place: Any, experiment: str, settings: list[str], clock: str, seed: int, local: Trace) -> dict[str, Any]:
    """One run through the command line, compared."""
    with tempfile.TemporaryDirectory() as folder:
        trace, report = Path(folder) / "trace.npz", Path(folder) / "report.json"
        options = [word for setting in settings for word in ("--set", setting)]
        files = ["--trace", str(trace), "--json", str(report)]
        ended = rig.hydrohil("run", experiment, "--clock", clock, "--seed", str(seed), *options, *files, place=place)
        if not trace.exists():
            rig.hydrohil("reset", place=place)
            words = json.loads(report.read_text()) if report.exists() else {}
            why = words.get("tripped") or words.get("gap") or ended.stderr.strip()[-200:]
            return {"clock": clock, "completed": False, "clean": False, "equal": False, "explained": True, "why": why}
        written = json.loads(report.read_text())
        difference = first_difference(read_trace(trace), local)
    late_tick = written["latencies"]["first_unanswered_tick"]
    counted = {name: written["latencies"][name] for name in (*FAULTS, "grid_shifts")}
    clean = clock == "lockstep" or not any(counted[name] for name in FAULTS)
    where = difference._asdict() if difference else None
    explained = difference is None or (late_tick is not None and difference.tick > late_tick)
    result = {"clock": clock, "completed": True, "clean": clean, "equal": difference is None, "explained": explained}
    return result | {"difference": where, "first_unanswered_tick": late_tick, **counted}


def series(given: Any, experiment: Experiment, local: Trace, *, realtime: bool) -> list[dict[str, Any]]:
    """Every run of both live clocks in one cell."""
    place, results = rig.place_of(given), []
    with rig.running(place, service_options(realtime=realtime)):
        for clock in given.clock or ("lockstep", "real"):
            for number in range(given.runs):
                with rig.console.status(f"{clock}, {scheduling(realtime)}: {number + 1} of {given.runs}"):
                    result = trial(place, given.experiment, given.set, clock, given.seed, local)
                results.append(result | {"realtime": realtime, "run": number})
                rig.console.print(words(results[-1]))
    return results


def scheduling(realtime: bool) -> str:
    """Scheduling class in words."""
    return "real-time" if realtime else "normal"


def words(result: dict[str, Any]) -> str:
    """One run in one line."""
    name = f"{result['clock']:8} {'rt' if result['realtime'] else 'no-rt':5} {result['run']:2}"
    if not result["completed"]:
        return f"{name}  did not complete: {result['why']}"
    counts = ", ".join(f"{result[key]} {key.replace('_', ' ')}" for key in (*FAULTS, "grid_shifts"))
    if result["equal"]:
        return f"{name}  equal to local; {counts}"
    where = result["difference"]
    late = result["first_unanswered_tick"]
    reason = f"the command of tick {late} was late" if result["explained"] else "NOTHING EXPLAINS IT"
    values = f"{where['here']}, local {where['local']}"
    return f"{name}  differs from tick {where['tick']} in {where['field']} ({values}); {counts}; {reason}"


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--runs", type=int, default=10, help="of each clock and scheduling class (10)")
    line.add_argument("--experiment", default="fig-4-25", help="fig-4-25")
    line.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", help="change one value of the experiment")
    line.add_argument("--seed", type=int, default=0, help="of noise and jitter (0)")
    line.add_argument("--clock", action="append", choices=("lockstep", "real"), help="only this one")
    line.add_argument("--no-realtime", action="store_true", help="only normal scheduling")
    line.add_argument("--realtime", action="store_true", help="only real-time scheduling")
    given = line.parse_args()
    experiment = with_overrides(find(given.experiment), given.set)
    local = rollout(experiment, given.seed)
    classes = [realtime for realtime, excluded in ((True, given.no_realtime), (False, given.realtime)) if not excluded]
    results = [result for realtime in classes for result in series(given, experiment, local, realtime=realtime)]
    rows, unexplained = [], 0
    for key in sorted({(result["clock"], result["realtime"]) for result in results}):
        these = [result for result in results if (result["clock"], result["realtime"]) == key]
        clean = [result for result in these if result["clean"]]
        completed, equal = sum(result["completed"] for result in these), sum(result["equal"] for result in clean)
        explained = sum(result["explained"] for result in these if result["completed"])
        unexplained += completed - explained
        rows.append((key[0], scheduling(key[1]), len(these), completed, len(clean), equal, explained))
    columns = ("clock", "scheduling", "runs", "completed", "clean", "equal of the clean", "equal up to the first late command")
    rig.table(experiment.name, columns, rows)
    rig.finish(given.json, {"experiment": experiment.name, "seed": given.seed, "results": results, "unexplained": unexplained})
    return 1 if unexplained else 0


if __name__ == "__main__":
    sys.exit(main())
