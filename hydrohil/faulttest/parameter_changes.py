"""Parameters that change while the machine moves or presses (rows 26, 27): nothing trips, the command goes by the tight limit."""

import json
import time
from collections.abc import Sequence
from functools import partial
from random import Random
from typing import NamedTuple

import numpy as np

from hydrohil.cell.processes import CellError
from hydrohil.experiment.criteria import RAMP_S
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import ScheduledChange, scheduled
from hydrohil.faulttest.motions import PRESS, SWING
from hydrohil.faulttest.observer import Observation
from hydrohil.faulttest.observer import moved as moved_since
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.simulations import PLAYED_S, at, ended, moved
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.contract.messages import Mode
from hydrohil.shared.units import NS_PER_S, SUBSTEP_NS
from hydrohil.simulation.columns import Columns
from hydrohil.simulation.rollout import play_local

PRESSING = (  # each row in a trial of its own: targets from soft to hard and light to heavy, gains from low to high
    ("controller.impedance.stiffness_n_per_m=20e3",),
    ("controller.impedance.stiffness_n_per_m=100e3", "controller.impedance.mass_kg=1000"),
    ("controller.impedance.mass_kg=200", "controller.impedance.damping_ratio=2"),
    ("controller.gains.down_up.kp_a_per_rad=6", "controller.gains.down_up.ki_a_per_rad_s=30"),
    ("controller.gains.down_up.kp_a_per_rad=20", "controller.gains.rotate.kp_a_per_rad=2"),
)
LAWS = ("pi", "vetia", "deadband", "morse", "hysteresis", "robust", "torque", "final")
EVERY_S = 0.7  # longer than the tight samples after a switch, shorter than half a period of the swing
HELD_CODES = 1  # a law that takes over holds the accepted current, which the converter truncates
SETTLED_S = 0.5  # after the last change
REFUSED = (
    "controller.gains.down_up.kp_a_per_rad=-0.001",
    "controller.impedance.stiffness_n_per_m=10000001",
    "controller.impedance.stiffness_n_per_m=nan",
    "controller.law=bang",
    "controller.lav=pi",
    "controller.slew_codes=2000",
    "controller.tight_slew_codes=2000",
    "controller.target=joint",
    "supervisor.force_limit_n=300",
    "plant.bias_s=1",
)


class Steps(NamedTuple):
    """The steps of the command while the tight limit was in force."""

    largest: int  # codes
    first: int  # at the samples at which a change begins
    limit: int
    samples: int


def pressed(seed: int) -> Trial:
    """In contact, at any force between 50 and 250 N: one of the changes, on the local clock."""
    chosen = PRESSING[seed % len(PRESSING)]
    return _played(PRESS, (ScheduledChange(at(seed), chosen),), seed)


def switched(seed: int) -> Trial:
    """While the link swings: one law after another."""
    at_s, laws = at(seed) - 1.0, Random(seed).sample(LAWS, len(LAWS))
    before = SWING.controller.law
    if before == laws[0]:  # a switch to the law that acts already would be no switch
        before = "pi"
    changes = (ScheduledChange(at_s + EVERY_S * i, (f"controller.law={law}",)) for i, law in enumerate(laws))
    motion = SWING._replace(controller=SWING.controller._replace(law=before))
    return _played(motion, tuple(change for change in changes if change.at_s < PLAYED_S - SETTLED_S), seed)


def _played(motion: Experiment, changes: tuple[ScheduledChange, ...], seed: int) -> Trial:
    experiment = motion._replace(duration_s=PLAYED_S, changes=changes)
    outcome, period_ns = play_local(experiment, seed), experiment.plant.sample_period_substeps * SUBSTEP_NS
    rows, asked = outcome.rows, [change.set for change in changes]
    requested = _requested_words(asked)
    if outcome.supervisor.mode != Mode.RUNNING:
        return Trial(False, f"{requested}: {ended(outcome).words}")
    waiting = scheduled(experiment.controller, changes, period_ns)
    firsts = [tick - outcome.first_tick for tick, _ in waiting]
    ramp = round(RAMP_S * NS_PER_S / period_ns) if "impedance" in requested else 1
    spans = [(first, first + ramp - 1 + experiment.controller.tight_samples) for first in firsts]
    steps = _steps(rows, spans, experiment.controller.tight_slew_codes)
    moved_mm, force_n = moved(experiment, rows, firsts[0], len(rows.tick) - 1)
    words = f"{requested}: {_words(steps)}; peak {rows.contact_force_n.max():.0f} N"
    return Trial(_continuous(steps, asked), words, moved_mm=moved_mm, force_n=force_n)


def _requested_words(changes: Sequence[Sequence[str]]) -> str:
    return "; ".join(", ".join(chosen) for chosen in changes)


def _words(steps: Steps) -> str:
    return f"steps of {steps.first} codes at the change, {steps.largest} in {steps.samples} samples, {steps.limit} are allowed"


def _continuous(steps: Steps, changes: Sequence[Sequence[str]]) -> bool:
    """Whether steps keep the tight limit, and a law that takes over holds the current."""
    switches = any("controller.law" in text for chosen in changes for text in chosen)
    return steps.samples > 0 and steps.largest <= steps.limit and not (switches and steps.first > HELD_CODES)


def _steps(rows: Columns, spans: Sequence[tuple[int, int]], limit: int) -> Steps:
    """Steps of the codes in the rows of each span, each against the row before."""
    step_codes = np.abs(np.diff(rows.dac_counts, axis=0)).max(axis=1)  # row i + 1 against row i
    inside = [int(step) for first, end in spans for step in step_codes[first - 1 : end - 1]]
    return Steps(max(inside), max(int(step_codes[first - 1]) for first, _ in spans), limit, len(inside))


def pressed_live(rig: Rig, rng: Random, number: int) -> Trial:
    """The same with real processes, at a random phase of the force, by the request of `hydrohil set`."""
    rig.start_moving(PRESS, rng)
    return _asked(rig, PRESS, (PRESSING[number % len(PRESSING)],))


def switched_live(rig: Rig, rng: Random, _: int) -> Trial:
    """Three laws in turn while the link swings."""
    rig.start_moving(SWING, rng)
    laws = [law for law in rng.sample(LAWS, 4) if law != SWING.controller.law][:3]
    return _asked(rig, SWING, [(f"controller.law={law}",) for law in laws])


def _asked(rig: Rig, experiment: Experiment, changes: Sequence[tuple[str, ...]]) -> Trial:
    spans, began_ns = [], time.monotonic_ns()
    for chosen in changes:
        answer = rig.ask("controller", "parameters", set=list(chosen))
        first = int(answer["number"])
        end = first + int(answer["ramp_samples"]) - 1 + experiment.controller.tight_samples
        spans.append((first, end))
        rig.wait_for(partial(_reached, rig, end), "the samples after the change")
    observed = rig.observer.listen_for(SETTLED_S)
    steps = _live_steps(observed, spans, experiment.controller.tight_slew_codes)
    runs = observed.permits[-1].body.mode == Mode.RUNNING
    words = f"{_requested_words(changes)}: {_words(steps)}" + ("" if runs else f"; {rig.state()}")
    moved_mm, force_n = moved_since(observed, began_ns)
    return Trial(runs and _continuous(steps, changes), words, moved_mm=moved_mm, force_n=force_n)


def _reached(rig: Rig, number: int) -> bool:
    return bool(rig.observer.listen().samples[-1].body.number >= number)


def _live_steps(observed: Observation, spans: Sequence[tuple[int, int]], limit: int) -> Steps:
    """Each command against the codes that the D/A held at the sample it answers: the controller knows no later ones."""
    held = {message.body.number: message.body.dac_counts for message in observed.samples}
    answers = [(message.header.echo_number, message.body.dac_counts) for message in observed.commands]
    step_of = {
        number: max(abs(code - before) for code, before in zip(codes, held[number], strict=True))
        for number, codes in answers
        if number in held
    }
    inside = [step_of[number] for first, end in spans for number in range(first, end) if number in step_of]
    return Steps(max(inside, default=0), max(step_of.get(first, 0) for first, _ in spans), limit, len(inside))


def refused_live(rig: Rig, rng: Random, _: int) -> Trial:
    """Out of bounds, unknown, of another section, or a limit: each is refused in contact, and nothing changes."""
    rig.start_moving(PRESS, rng)
    before = rig.status("controller")["changed"]
    answers = {text: rig.bus.ask("controller", "parameters", {"set": [text]}, 2.0) for text in REFUSED}
    silent = [text for text, answer in answers.items() if answer is None]
    if silent:
        raise CellError(f"no answer to {', '.join(silent)}")
    taken = [text for text, answer in answers.items() if answer is not None and answer.accepted]
    mixed = rig.bus.ask("controller", "parameters", {"set": ["controller.law=pi", REFUSED[0]]}, 2.0)
    if mixed is None or mixed.accepted:
        taken.append("half of a change")
    after, mode = rig.status("controller")["changed"], rig.status("supervisor").get("mode")
    words = f"{len(REFUSED) + 1 - len(taken)} of {len(REFUSED) + 1} refused; changed: {json.dumps(after)}; {mode}"
    return Trial(not taken and before == after == [] and mode == Mode.RUNNING.name, words)
