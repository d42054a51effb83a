"""A trial on the local clock: an experiment in, its rows out."""

from typing import Any, NamedTuple

import numpy as np

from rollout.cell import Columns, Setup, columns, play
from services.controller.config import ControllerConfig, Reference, controller_params, segment_table
from services.controller.step import control_start
from services.plant.about import about
from services.plant.config import GateLimits, PlantConfig, bias_ticks, latch_substeps
from services.plant.gate import GateMemory
from services.plant.machine import machine_start
from services.plant.noise import force_noise_n, sample_intervals
from services.plant.params import contact_params
from services.supervisor.config import SupervisorConfig
from services.supervisor.params import supervisor_params
from services.supervisor.step import SupervisorMemory
from shared.kernel import compiled
from shared.units import NS_PER_S, SUBSTEP_NS

SEGMENT_COLUMNS = 9


class Trial(NamedTuple):
    """What the local cell needs of an experiment."""

    plant: PlantConfig
    controller: ControllerConfig
    supervisor: SupervisorConfig
    reference: Reference
    duration_s: float


class Outcome(NamedTuple):
    """Rows from the trial's first (negative) tick on, and how it ended."""

    rows: Columns
    first_tick: int
    latch_ns: int
    supervisor: SupervisorMemory
    gate: GateMemory


_compiled: dict[str, Any] = {}


def duration_ticks(duration_s: float, plant: PlantConfig) -> int:
    """Samples from tick 0 to the end of the trial."""
    return round(duration_s * NS_PER_S / (plant.sample_period_substeps * SUBSTEP_NS))


def setup(trial: Trial, limits: GateLimits) -> Setup:
    """Parameters and initial state; raises ValueError if the sections do not fit together."""
    contact = contact_params(trial.plant.environment)
    described = about(trial.plant, limits)
    first = -bias_ticks(trial.plant)
    return Setup(
        trial.plant.machine,
        contact,
        limits,
        controller_params(trial.controller, described, first),
        supervisor_params(trial.supervisor, described, -first, duration_ticks(trial.duration_s, trial.plant)),
        machine_start(trial.plant.machine, contact, trial.plant.initial_q_rad),
        first,
        latch_substeps(trial.plant),
    )


def play_local(trial: Trial, seed: int, limits: GateLimits | None = None) -> Outcome:
    """Run `trial` in one compiled loop with the noise and jitter of `seed`."""
    made = setup(trial, limits or GateLimits())
    count = made.supervise.duration_ticks - made.first_tick
    machine = trial.plant.machine
    noise_n = force_noise_n(seed, made.first_tick, count, machine.force_noise_sigma_n, machine.force_noise_clip_n)
    intervals = sample_intervals(
        seed, made.first_tick, count, trial.plant.sample_period_substeps, trial.plant.jitter_substeps
    )
    table = np.array(segment_table(trial.reference), dtype=np.float64).reshape(-1, SEGMENT_COLUMNS)
    out = columns(count)
    if "play" not in _compiled:
        _compiled["play"] = compiled(play)
    watch, gate, rows = _compiled["play"](made, control_start(made.control), table, noise_n, intervals, out)
    return Outcome(
        Columns(*(column[:rows] for column in out)),
        made.first_tick,
        made.latch_substeps * SUBSTEP_NS,
        SupervisorMemory(*watch),
        GateMemory(*gate),
    )
