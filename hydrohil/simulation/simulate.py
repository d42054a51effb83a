"""A trial on the local clock, judged."""

import time

from hydrohil.experiment.experiment import Experiment, checked_seed, validate, warnings
from hydrohil.experiment.run import Run, verdicts_of
from hydrohil.shared.contract.messages import Mode
from hydrohil.shared.trips.causes import trip_words
from hydrohil.simulation.rollout import play_local, trace_of
from hydrohil.simulation.trip_local import local_report


def simulate(experiment: Experiment, seed: int = 0) -> Run:
    """Run a trial on the local clock: plant, gate, controller and supervisor in one compiled loop, no processes, no waiting.

    The result depends on `experiment` and on `seed` alone, which draws noise, jitter and faults; in lockstep, the same trial
    in a cell gives the same numbers. The first call after a change of the sources compiles, some ten seconds.
    Raises ExperimentError where the experiment cannot run, or has faults that only a cell can play (processes, transport).
    """
    experiment, seed, began = validate(experiment), checked_seed(seed), time.perf_counter()
    outcome = play_local(experiment, seed)
    ended, trace = outcome.supervisor, trace_of(outcome)
    tripped = ended.mode == Mode.TRIPPED
    trip = trip_words(ended.cause, ended.measured, ended.limit, ended.trip_number) if tripped else ""
    return Run(
        experiment,
        clock="local",
        seed=seed,
        trace=trace,
        verdicts=verdicts_of(experiment, trace, trip),
        trip=trip,
        wall_s=time.perf_counter() - began,
        warnings=warnings(experiment),
        trip_report=local_report(experiment, outcome),
    )
