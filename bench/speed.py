"""How many times faster than real time the local clock runs whole cells, on one core, and where the time goes.

Simulated seconds, the removal of the bias included, per second of processor time of a trial with its preparation, after
compilation; best of several.
The machine alone is the same trial's codes played again without anybody who computes them; what is left over is controller,
supervisor, gate, sensors and rows, once a sample, and the preparation. Example: python bench/speed.py --trials 5
"""

import sys
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import rig

from hydrohil.experiment.experiment import Experiment
from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.machine import MachineState, advance
from hydrohil.services.plant.noise import sample_intervals
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.simulation.loop import Setup
from hydrohil.simulation.rollout import play_local, setup
from hydrohil.thesis.library import find

EXPERIMENTS = ("fig-4-25", "fig-5-5", "fig-5-11", "fig-5-13", "fig-7-1")
NS = 1e9


class Speed(NamedTuple):
    """Of the fastest trial."""

    times_real_time: float
    substep_ns: float  # of the machine
    machine_ns: float  # a sample
    rest_ns: float  # a sample


def machine_alone(prepared: Setup, codes: Any, intervals: Any) -> MachineState:
    """The machine at the end of a trial without faults, whose codes (n, 3) are written at the latch from tick 0 on."""
    state, held = prepared.start, (ZERO_CODE, ZERO_CODE, ZERO_CODE)
    for i in range(len(codes)):
        state = advance(state, prepared.machine, prepared.contact, held, prepared.latch_substeps)
        if prepared.first_tick + i >= 0:
            held = (codes[i, 0], codes[i, 1], codes[i, 2])
        state = advance(state, prepared.machine, prepared.contact, held, intervals[i] - prepared.latch_substeps)
    return state


def fastest_s(run: Callable[[int], object], trials: int) -> float:
    """Processor time of the fastest; the first, which may compile, does not count."""
    run(0)
    taken_s = []
    for seed in range(trials):
        began = time.process_time()
        run(seed)
        taken_s.append(time.process_time() - began)
    return min(taken_s)


def speed_of(experiment: Experiment, trials: int, alone: Any) -> Speed:
    """One experiment."""
    prepared, rows, plant = setup(experiment, GateLimits()), play_local(experiment, 0).rows, experiment.plant
    count = len(rows.tick)
    intervals = sample_intervals(0, prepared.first_tick, count, plant.sample_period_substeps, plant.jitter_substeps)
    codes = rows.dac_counts.copy()
    whole_s = fastest_s(lambda seed: play_local(experiment, seed), trials)
    machine_s = fastest_s(lambda _: alone(prepared, codes, intervals), trials)
    return Speed(
        (experiment.duration_s + plant.bias_s) / whole_s,
        machine_s / int(intervals.sum()) * NS,
        machine_s / count * NS,
        (whole_s - machine_s) / count * NS,
    )


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--trials", type=int, default=5, help="of each experiment (5)")
    given = line.parse_args()
    with rig.console.status("the first trial after a change compiles"):
        alone = compiled(machine_alone)
        found = {name: speed_of(find(name), given.trials, alone) for name in EXPERIMENTS}
    columns = ("experiment", "times real time", "ns a sub-step", "machine, ns a sample", "the rest, ns a sample")
    rig.table("local clock", columns, [(name, *speed) for name, speed in found.items()])
    rig.finish(given.json, {name: speed._asdict() for name, speed in found.items()})
    return 0


if __name__ == "__main__":
    sys.exit(main())
