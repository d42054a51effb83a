"""How many trials of fig-4-25 a campaign does a second, beside the limit: the same processes doing nothing but its kernel.

The limit is measured before and after, with one process a core. Cores used: processor time of workers over wall time, from the
first chunk sent to the last row kept. Example: python bench/campaign.py --trials 10000
"""

import os
import sys
import tempfile
import time
from pathlib import Path

import psutil
import rig
from distributed import Client

from hydrohil.campaign.campaign import Plan
from hydrohil.campaign.cluster import cluster
from hydrohil.campaign.dispatch import pending, run_trials, trial_s
from hydrohil.campaign.reading import from_table
from hydrohil.campaign.store import opened
from hydrohil.campaign.work import warm
from hydrohil.simulation.rollout import play_local
from hydrohil.thesis.library import find

NAME, LIMIT_S = "fig-4-25", 10.0


def planned(trials: int) -> Plan:
    """As many seeds of the experiment, all of its claims judged."""
    sweep = {"controller.law": {"list": ["final"]}}
    words = {"name": "bench", "title": "Bench", "experiment": NAME, "claims": True, "repeats": trials, "sweep": sweep}
    return from_table(words, Path("bench.toml"))


def bare(lasts_s: float) -> float:
    """Trials a second of a process that only plays."""
    experiment, began, done = find(NAME), time.perf_counter(), 0
    while time.perf_counter() - began < lasts_s:
        play_local(experiment, done)
        done += 1
    return done / (time.perf_counter() - began)


def limit_per_s(client: Client) -> float:
    """Trials a second of all workers at once."""
    sent = [client.submit(bare, LIMIT_S, workers=[worker], pure=False) for worker in client.nthreads()]
    return sum(client.gather(sent))


def processor_s(client: Client) -> float:
    """Processor time that the workers have used so far."""
    used = [psutil.Process(pid).cpu_times() for pid in client.run(os.getpid).values()]
    return sum(times.user + times.system for times in used)


def measured(client: Client, plan: Plan, folder: Path) -> dict[str, float]:
    """One campaign on workers that are warm."""
    for worker in client.nthreads():
        client.submit(warm, plan, workers=[worker], pure=False).result()
    before_per_s = limit_per_s(client)
    with opened(plan, folder, fresh=True) as store:
        todo, used_s, began = pending(store), processor_s(client), time.perf_counter()
        run_trials(client, store, todo, trial_s(plan.base), lambda _: None)
        wall_s, used_s = time.perf_counter() - began, processor_s(client) - used_s
        finished = store.finish().num_rows
    limit = (before_per_s + limit_per_s(client)) / 2.0
    rate = finished / wall_s
    return {
        "trials": finished,
        "wall_s": wall_s,
        "trials_per_s": rate,
        "limit_per_s": limit,
        "of_the_limit": rate / limit,
        "cores_used": used_s / wall_s,
        "times_real_time": rate * (plan.base.duration_s + plan.base.plant.bias_s),
    }


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--trials", type=int, default=2000, help="of fig-4-25 (2000)")
    line.add_argument("--workers", type=int, default=len(os.sched_getaffinity(0)), help="processes (one a core)")
    given = line.parse_args()
    with (
        rig.console.status("the first trial after a change compiles"),
        tempfile.TemporaryDirectory() as folder,
        cluster(given.workers, None) as client,
    ):
        found = measured(client, planned(given.trials), Path(folder))
    rig.table(f"campaign of {NAME}, {given.workers} processes", ("figure", "value"), list(found.items()))
    rig.finish(given.json, found)
    return 0


if __name__ == "__main__":
    sys.exit(main())
