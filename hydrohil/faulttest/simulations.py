"""Faults on the local clock: the tick at which the D/A is at zero, counted from the tick at which the fault begins."""

import math
from collections.abc import Callable
from random import Random
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import GateLimits
from hydrohil.faulttest.motions import PRESS, SWING
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.contract.converters import ZERO_CODE, code_to_current
from hydrohil.shared.contract.faults import Fault, ticks_of
from hydrohil.shared.contract.messages import GateCause, Mode, TripCause
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.trips.causes import trip_words
from hydrohil.shared.units import NS_PER_S, SUBSTEP_S
from hydrohil.simulation.columns import Columns
from hydrohil.simulation.rollout import Outcome, play_local
from hydrohil.simulation.tips import tips_m

PLAYED_S = 6.0
FIRST_S, LAST_S = 1.5, 3.5  # the fault begins between these
LINK = 1  # down/up, which swings
MOVES_WITHIN_S = UNIMATE.motion.moves_within_ns / NS_PER_S
MOTIONS = {"swing": SWING, "press": PRESS}


Bools = npt.NDArray[np.bool_]


class Ended(NamedTuple):
    """The end of a local trial: the row of zero current, and what led to it."""

    row: int  # of the sample at whose latch the D/A is at zero; beyond the last = never
    words: str


def at(seed: int) -> float:
    """When the fault of this seed begins, in s of the trial."""
    return Random(seed).uniform(FIRST_S, LAST_S)


def ended(outcome: Outcome) -> Ended:
    """The row of zero current: where the supervisor trips, or the one before, at which the gate had cut."""
    rows, watch, gate = len(outcome.rows.tick), outcome.supervisor, outcome.gate
    if watch.mode != Mode.TRIPPED:
        return Ended(rows, "nothing tripped")
    if watch.cause == TripCause.GATE_CUT:
        return Ended(rows - 2, f"the gate: {GateCause(gate.cause).name}")
    return Ended(rows - 1, f"the supervisor: {trip_words(watch.cause, watch.measured, watch.limit, watch.trip_number)}")


def period_s(experiment: Experiment) -> float:
    """The sampling period T in s."""
    return experiment.plant.sample_period_substeps * SUBSTEP_S


def fault_trial(seed: int, motion: str, faults: Callable[[float], tuple[Fault, ...]], bound: Callable[[float], float]) -> Trial:
    """A trial of `motion` with `faults`, a function of the time at which they begin; `bound` is a function of T, both in s."""
    at_s = at(seed)
    experiment = MOTIONS[motion]._replace(duration_s=PLAYED_S, faults=faults(at_s))
    outcome = play_local(experiment, seed)
    return timed(experiment, outcome, first_with(experiment, outcome), bound(period_s(experiment)))


def immobile_trial(seed: int, kind: str, target: str, value: float) -> Trial:
    """A fault of valve, supply or encoder of the down/up link, timed from where the current must move the link and does not.

    200 ms of such a current, rounded up to a whole sample, and the sample that first shows the current: 200 ms + 2 T.
    """
    at_s = at(seed)
    experiment = SWING._replace(
        duration_s=PLAYED_S, faults=(Fault(kind=kind, target=target, at_s=at_s, lasts_s=0.0, value=value),)
    )
    outcome = play_local(experiment, seed)
    first, end = first_with(experiment, outcome), ended(outcome)
    since = max(first, undriven_since(outcome.rows, min(end.row, len(outcome.rows.tick) - 1)))
    trial = timed(experiment, outcome, since, math.nan)
    bound_s = MOVES_WITHIN_S + 2.0 * period_s(experiment)
    reaction_s = trial.reaction_s - outcome.latch_ns / NS_PER_S  # the current stands from the latch of its row on
    held = trial.held and reaction_s <= bound_s
    words = f"{end.row - first} samples after the fault, {end.row - since} after the current that must move it; {end.words}"
    return trial._replace(held=held, words=words, reaction_s=reaction_s, bound_s=bound_s)


def undriven_since(rows: Columns, end: int) -> int:
    """The first row from which up to `end` a current stands that must move link 2, while the link does not move with it."""
    sign = 1 if rows.dac_counts[end - 1, LINK] > ZERO_CODE else -1
    must_a = UNIMATE.motion.moves_up_a[LINK] if sign > 0 else UNIMATE.motion.moves_down_a[LINK]
    row = end
    while row > 0 and sign * code_to_current(UNIMATE.drive, int(rows.dac_counts[row - 1, LINK])) >= must_a:
        if sign * (rows.q[row, LINK] - rows.q[row - 1, LINK]) > 0.0:
            break
        row -= 1
    return row


def first_with(experiment: Experiment, outcome: Outcome) -> int:
    """The row of the first sample that has the experiment's first fault."""
    first, _ = ticks_of(experiment.faults[0], round(period_s(experiment) * NS_PER_S))
    return first - outcome.first_tick


def timed(experiment: Experiment, outcome: Outcome, row: int, bound_s: float) -> Trial:
    """From the sample of `row` to the latch at which the current is zero."""
    rows, end = outcome.rows, ended(outcome)
    if end.row < row:
        return Trial(False, f"ended before its fault: {end.words}")
    reached = min(end.row, len(rows.tick) - 1)
    moved_mm, force_n = moved(experiment, rows, row, reached)
    if end.row >= len(rows.tick):
        return Trial(False, end.words, bound_s=bound_s, moved_mm=moved_mm, force_n=force_n)
    reaction_s = float(rows.time_ns[end.row] - rows.time_ns[row] + outcome.latch_ns) / NS_PER_S
    words = f"{end.row - row} samples after the first that has it; {end.words}"
    return Trial(
        held=math.isnan(bound_s) or reaction_s <= bound_s,
        words=words,
        reaction_s=reaction_s,
        bound_s=bound_s,
        stalled_s=0.0,
        moved_mm=moved_mm,
        force_n=force_n,
    )


def moved(experiment: Experiment, rows: Columns, row: int, end: int) -> tuple[float, float]:
    """Largest distance of the true tip (mm) and change of the true contact force (N) between two rows."""
    tips = tips_m(experiment.plant.machine, rows.true_q[row : end + 1])
    force = rows.contact_force_n[row : end + 1]
    return max(1000.0 * math.dist(place, tips[0]) for place in tips), float(np.max(np.abs(force - force[0])))


def limit_trial(
    seed: int,
    experiment: Experiment,
    beyond: Callable[[Columns], Bools],
    bound: Callable[[float], float],
    limits: GateLimits | None = None,
) -> Trial:
    """From the first sample that is `beyond` a limit; the experiment itself leads there."""
    outcome = play_local(experiment, seed, limits)
    rows = np.flatnonzero(beyond(outcome.rows))
    if not len(rows):
        return Trial(False, f"the limit was never crossed: {ended(outcome).words}")
    return timed(experiment, outcome, int(rows[0]), bound(period_s(experiment)))
