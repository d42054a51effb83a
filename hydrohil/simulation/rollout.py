"""A trial on the local clock: an experiment in, its rows and its trace out."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from hydrohil.claims.trace import Trace
from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import Experiment
from hydrohil.services.controller.config import controller_params, segment_table
from hydrohil.services.controller.parameter_change import handed_over
from hydrohil.services.controller.parameter_schedule import ParameterSchedule, advance, at, moves, scheduled
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
from hydrohil.services.supervisor.state import SupervisorMemory
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.contract.faults import problem
from hydrohil.shared.units import NS_PER_S, SUBSTEP_NS
from hydrohil.simulation.columns import Columns, columns
from hydrohil.simulation.loop import Setup, Underway, begin, play

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
    """What breaks, a row each, (n, 6). Raises ExperimentError with one line for what cannot be broken on the local clock."""
    for fault in experiment.faults:
        if what := problem(fault, "local"):
            raise ExperimentError([what])
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
    prepared = setup(experiment, limits or GateLimits())
    first, plant, machine = prepared.first_tick, experiment.plant, experiment.plant.machine
    count = prepared.supervise.duration_ticks - first
    noise_n = force_noise_n(seed, first, count, machine.force_noise_sigma_n, machine.force_noise_clip_n)
    intervals = sample_intervals(seed, first, count, plant.sample_period_substeps, plant.jitter_substeps)
    table = np.array(segment_table(experiment.reference), dtype=np.float64).reshape(-1, SEGMENT_COLUMNS)
    faults, out = fault_table(experiment, seed), columns(count)
    if "play" not in _compiled:
        _compiled["play"] = compiled(play)

    def play_to(prepared: Setup, underway: Underway, end: int) -> Underway:
        return Underway(
            *_compiled["play"](
                setup=prepared,
                underway=underway,
                table=table,
                faults=faults,
                noise_n=noise_n,
                intervals=intervals,
                out=out,
                end=end,
            )
        )

    start = begin(prepared, control_start(prepared.control), intervals)
    end = _play_schedule(experiment, prepared, start, count, play_to)
    return Outcome(
        rows=_rows(out, slice(end.row)),
        first_tick=first,
        latch_ns=prepared.latch_substeps * SUBSTEP_NS,
        supervisor=SupervisorMemory(*end.watch),
        gate=GateMemory(*end.gate),
    )


def _play_schedule(
    experiment: Experiment, prepared: Setup, underway: Underway, count: int, play_to: Callable[[Setup, Underway, int], Underway]
) -> Underway:
    """From one change of the parameters to the next; without any, all at once."""
    described, period_ns = describe(experiment.plant, prepared.limits), experiment.plant.sample_period_substeps * SUBSTEP_NS
    schedule = ParameterSchedule(experiment.controller, scheduled(experiment.controller, experiment.changes, period_ns))
    first = prepared.first_tick
    while (row := underway.row) < count and underway.watch.mode == RUNNING:
        schedule, change = advance(schedule, row, first + row, period_ns)
        if change is not None:
            underway = underway._replace(control=handed_over(underway.control, change))
        if moves(schedule, row):
            prepared = prepared._replace(control=controller_params(at(schedule, row), described, first))
        ends = [count, *(tick - first for tick, _ in schedule.waiting)]
        underway = play_to(prepared, underway, row + 1 if moves(schedule, row + 1) else min(ends))
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
