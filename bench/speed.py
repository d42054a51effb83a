"""How many times faster than real time the local clock runs whole cells, on one core, after compilation.

Simulated seconds, the removal of the bias included, per wall second of a trial with its preparation; best of several.
Example: python bench/speed.py --trials 5
"""

import sys
import time

import rig

from experiments.library import find
from rollout.rollout import play_local

EXPERIMENTS = ("fig-4-25", "fig-5-5", "fig-5-11", "fig-5-13", "fig-7-1")


def times_real_time(name: str, trials: int) -> float:
    """Of the fastest trial; the first, which may compile, does not count."""
    experiment = find(name)
    play_local(experiment, 0)
    taken_s = []
    for seed in range(trials):
        began = time.perf_counter()
        play_local(experiment, seed)
        taken_s.append(time.perf_counter() - began)
    return (experiment.duration_s + experiment.plant.bias_s) / min(taken_s)


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--trials", type=int, default=5, help="of each experiment (5)")
    given = line.parse_args()
    with rig.console.status("the first trial after a change compiles"):
        rows = [(name, times_real_time(name, given.trials)) for name in EXPERIMENTS]
    rig.table("local clock", ("experiment", "times real time"), rows)
    rig.finish(given.json, {"times_real_time": dict(rows)})
    return 0


if __name__ == "__main__":
    sys.exit(main())
