"""A trial on the local clock: an experiment in, its rows and its trace out."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from hydrohil.claims.trace import Trace
from hydrohil.experiment.experiment import Experiment
from hydrohil.services.controller.config import controller_params, segment_table
from hydrohil.services.controller.parameter_change import handed_over
from hydrohil.services.controller.parameter_schedule import ParameterSchedule, at, follow, moves, scheduled
from hydrohil.services.controller.step import control_start
from hydrohil.services.plant.config import GateLimits, PlantConfig, latch_substeps, tare_ticks, trial_ticks
from hydrohil.services.plant.faults import COLUMNS, fault_row
from hydrohil.services.plant.gate import GateMemory
from hydrohil.services.plant.machine import machine_start
from hydrohil.services.plant.noise import force_noise_n, sample_intervals
from hydrohil.services.plant.params import contact_params
from hydrohil.services.plant.plant_description import describe
from hydrohil.services.supervisor.modes import RUNNING
from hydrohil.services.supervisor.params import supervisor_params
from hydrohil.services.supervisor.step import SupervisorMemory
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.contract.faults import problem
from hydrohil.shared.units import NS_PER_S, SUBSTEP_NS
from hydrohil.simulation.loop import Columns, Setup, Underway, begin, columns, play

SEGMENT_COLUMNS = 9


class Outcome(NamedTuple):
    """Rows from the trial's first (negative) tick on, and how it ended."""

    rows: Columns
    first_tick: int
    latch_ns: int
    supervisor: SupervisorMemory
    gate: GateMemory


_compiled: dict[str, Any] = {}


def duration_ticks(duration_s: float, plant: PlantConfig) -> int:
    """Samples from tick 0 to the end of the experiment."""
    return trial_ticks(plant, duration_s)[1]


def fault_table(experiment: Experiment, seed: int) -> Any:
    """Rows of what breaks, shape (n, 6); raises ValueError with one line for what a local run cannot break."""
    for fault in experiment.faults:
        if what := problem(fault, "local"):
            raise ValueError(what)
    period_ns = experiment.plant.sample_period_substeps * SUBSTEP_NS
    rows = [fault_row(fault, seed, period_ns) for fault in experiment.faults]
    return np.array(rows, dtype=np.float64).reshape(-1, COLUMNS)


def setup(experiment: Experiment, limits: GateLimits) -> Setup:
    """Parameters and initial state; raises ValueError if the sections do not fit together."""
    contact = contact_params(experiment.plant.environment)
    described = describe(experiment.plant, limits)
    first = -tare_ticks(experiment.plant)
    return Setup(
        machine=experiment.plant.machine,
        contact=contact,
        limits=limits,
        control=controller_params(experiment.controller, described, first),
        supervise=supervisor_params(
            experiment.supervisor, described, -first, duration_ticks(experiment.duration_s, experiment.plant)
        ),
        start=machine_start(experiment.plant.machine, contact, experiment.plant.initial_q),
        first_tick=first,
        latch_substeps=latch_substeps(experiment.plant),
    )


def play_local(experiment: Experiment, seed: int, limits: GateLimits | None = None) -> Outcome:
    """Run `experiment` in one compiled loop with the noise and jitter of `seed`."""
    made = setup(experiment, limits or GateLimits())
    count = made.supervise.duration_ticks - made.first_tick
    machine = experiment.plant.machine
    noise_n = force_noise_n(seed, made.first_tick, count, machine.force_noise_sigma_n, machine.force_noise_clip_n)
    intervals = sample_intervals(
        seed, made.first_tick, count, experiment.plant.sample_period_substeps, experiment.plant.jitter_substeps
    )
    table = np.array(segment_table(experiment.reference), dtype=np.float64).reshape(-1, SEGMENT_COLUMNS)
    broken = fault_table(experiment, seed)
    out = columns(count)
    if "play" not in _compiled:
        _compiled["play"] = compiled(play)

    def go_on(made: Setup, underway: Underway, end: int) -> Underway:
        return Underway(*_compiled["play"](made, underway, table, broken, noise_n, intervals, out, end))

    start = begin(made, control_start(made.control), intervals)
    end = _play_schedule(experiment, made, start, count, go_on)
    return Outcome(
        _rows(out, slice(end.row)),
        made.first_tick,
        made.latch_substeps * SUBSTEP_NS,
        SupervisorMemory(*end.watch),
        GateMemory(*end.gate),
    )


def _play_schedule(
    experiment: Experiment, made: Setup, underway: Underway, count: int, go_on: Callable[[Setup, Underway, int], Underway]
) -> Underway:
    """From one change of the parameters to the next; without any, all at once."""
    described, period_ns = describe(experiment.plant, made.limits), experiment.plant.sample_period_substeps * SUBSTEP_NS
    schedule = ParameterSchedule(experiment.controller, scheduled(experiment.controller, experiment.changes, period_ns))
    while (row := underway.row) < count and underway.watch.mode == RUNNING:
        schedule, change = follow(schedule, row, made.first_tick + row, period_ns)
        if change is not None:
            underway = underway._replace(control=handed_over(underway.control, change))
        if moves(schedule, row):
            made = made._replace(control=controller_params(at(schedule, row), described, made.first_tick))
        ends = [count, *(tick - made.first_tick for tick, _ in schedule.waiting)]
        underway = go_on(made, underway, row + 1 if moves(schedule, row + 1) else min(ends))
    return underway


def _rows(out: Columns, chosen: slice) -> Columns:
    values: dict[str, Any] = {name: column[chosen] for name, column in out._asdict().items()}
    return Columns(**values)


def trace_of(outcome: Outcome) -> Trace:
    """The rows from tick 0 on, as a trace."""
    rows = _rows(outcome.rows, slice(-outcome.first_tick, None))
    shared = {name: getattr(rows, name) for name in Trace._fields if name in Columns._fields}
    return Trace(
        t_s=rows.time_ns / NS_PER_S,
        sample_age_s=np.full(len(rows.tick), outcome.latch_ns / NS_PER_S),
        **shared,
    )


def rollout(experiment: Experiment, seed: int) -> Trace:
    """One trial's trace with the noise and jitter of `seed`."""
    return trace_of(play_local(experiment, seed))
