"""A link that is no Unimate: known plants behind the interface of a rig, solved by scipy, read by an encoder."""

import numpy as np
from scipy.signal import TransferFunction, lsim

from hydrohil.claims.signals import COUNT_Q
from hydrohil.claims.trace import Trace
from hydrohil.experiment.experiment import Experiment
from hydrohil.services.controller.config import segment_table
from hydrohil.services.controller.reference import reference_deltas
from hydrohil.thesis.library import find
from hydrohil.tuning.bench import Bench
from tests.hydrohil.claims.test_trace import standing

EXPERIMENT = find("fig-4-25")
GAINS = EXPERIMENT.controller.gains[1]
LINK = 1
COUNT = COUNT_Q[LINK]


def bench(run, seeds=1) -> Bench:
    return Bench(run, EXPERIMENT, LINK, tuple(range(seeds)))


def reference(experiment: Experiment) -> tuple[Trace, np.ndarray]:
    """A rig at rest for the trial, and the set-point of link 2 without its start (n,)."""
    trace = standing(experiment.duration_s)
    table = segment_table(experiment.reference)
    return trace, np.array([reference_deltas(table, t)[LINK] for t in trace.t_s.tolist()])


def as_trace(trace: Trace, setpoint: np.ndarray, position: np.ndarray, kp: float) -> Trace:
    """What the rig reads of a link under P control: whole counts, and the current that they ask for."""
    counted = np.floor(position / COUNT + 0.5) * COUNT
    columns = {"q_set": setpoint, "q": counted, "current_a": kp * (setpoint - counted)}
    speeds = {"qd_set": np.gradient(setpoint, trace.t_s), "qd": np.gradient(counted, trace.t_s)}
    return trace._replace(**{name: np.outer(values, [0.0, 1.0, 0.0]) for name, values in {**columns, **speeds}.items()})


def resonant(speed_q_per_s_a: float, frequency_hz: float, damping: float):
    """A run of a link whose speed follows the current through one mode,  q = K w^2 / (s (s^2 + 2 d w s + w^2)) u.

    Under P control it is stable below K_P = 2 d w / K (Routh).
    """
    w = 2.0 * np.pi * frequency_hz

    def run(experiment: Experiment, seed: int) -> Trace:
        kp = experiment.controller.gains[LINK].kp_a_per_q
        trace, setpoint = reference(experiment)
        loop = kp * speed_q_per_s_a * w * w
        with np.errstate(over="ignore", invalid="ignore"):
            _, position, _ = lsim(TransferFunction([loop], [1.0, 2.0 * damping * w, w * w, loop]), setpoint, trace.t_s)
        position = np.clip(np.nan_to_num(position), -1.0, 1.0)
        return as_trace(trace, setpoint, position, kp)

    return run, 2.0 * damping * w / speed_q_per_s_a


def stuck_until(positive_a: float, negative_a: float, jump_counts: int = 3):
    """A run of a link that stands until the current reaches its break-away, then jumps there and goes on standing."""

    def run(experiment: Experiment, seed: int) -> Trace:
        kp = experiment.controller.gains[LINK].kp_a_per_q
        trace, setpoint = reference(experiment)
        position, here = np.zeros(len(setpoint)), 0.0
        for row, set_to in enumerate(setpoint.tolist()):
            current = kp * (set_to - here)
            if not -negative_a <= current <= positive_a:
                here += jump_counts * COUNT * np.sign(current)
            position[row] = here
        return as_trace(trace, setpoint, position, kp)

    return run
