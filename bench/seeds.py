"""Every shipped experiment over many seeds on the local clock: does a rule trip, how often does each claim hold, how fast.

Example: python bench/seeds.py --seeds 20 --json seeds.json
"""

import sys
import time
from typing import Any

import rig

from experiments.claims import judge
from experiments.experiment import Experiment
from experiments.library import catalogue, find
from rollout.rollout import play_local, trace_of
from services.supervisor.rules import WORDS
from shared.messages import Mode, TripCause

SPEED_OF = "fig-4-25"
SPEED_TRIALS = 5


def battery(experiment: Experiment, seeds: int) -> dict[str, Any]:
    """Trips, and how many seeds each claim holds in."""
    trips, holding = [], [0] * len(experiment.claims)
    for seed in range(seeds):
        outcome = play_local(experiment, seed)
        trip = outcome.supervisor
        if trip.mode == Mode.TRIPPED:
            trips.append(f"seed {seed}: {WORDS[TripCause(trip.cause)]}: {trip.measured:.4g} against {trip.limit:.4g}")
            continue
        trace = trace_of(outcome)
        for number, claim in enumerate(experiment.claims):
            holding[number] += judge(claim, trace).holds
    claims = [{"statement": c.statement, "holds": count} for c, count in zip(experiment.claims, holding, strict=True)]
    return {"experiment": experiment.name, "alias": experiment.alias, "trips": trips, "claims": claims}


def speed() -> float:
    """Simulated seconds (bias included) per wall second of the compiled loop with its preparation, best of five."""
    experiment = find(SPEED_OF)
    play_local(experiment, 0)
    taken_s = []
    for seed in range(SPEED_TRIALS):
        began = time.perf_counter()
        play_local(experiment, seed)
        taken_s.append(time.perf_counter() - began)
    return (experiment.duration_s + experiment.plant.bias_s) / min(taken_s)


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--seeds", type=int, default=20, help="seeds of each experiment (20)")
    line.add_argument("--experiment", action="append", help="only this one; may be repeated")
    given = line.parse_args()
    chosen = [find(name) for name in given.experiment] if given.experiment else catalogue()
    results = []
    with rig.console.status("compiling") as status:
        for number, experiment in enumerate(chosen, 1):
            status.update(f"{number} of {len(chosen)}: {experiment.name}")
            results.append(battery(experiment, given.seeds))
        times = speed()
    rows = [
        (result["experiment"], claim["statement"], f"{claim['holds']} of {given.seeds}")
        for result in results
        for claim in result["claims"]
    ]
    rig.table("claims over seeds", ("experiment", "claim", "holds in"), rows)
    trips = [f"{result['experiment']}, {trip}" for result in results for trip in result["trips"]]
    for trip in trips:
        rig.console.print(f"[red]TRIPPED[/] {trip}")
    full = sum(claim["holds"] == given.seeds for result in results for claim in result["claims"])
    rig.console.print(
        f"{len(results)} experiments, {given.seeds} seeds: {len(trips)} trips; {full} of {len(rows)} claims always hold"
    )
    rig.console.print(f"local clock: {times:.0f} times real time ({SPEED_OF}, after compilation)")
    rig.finish(given.json, {"seeds": given.seeds, "experiments": results, "trips": len(trips), "times_real_time": times})
    return 1 if trips else 0


if __name__ == "__main__":
    sys.exit(main())
