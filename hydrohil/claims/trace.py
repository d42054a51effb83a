"""The record of one trial: a row per sample from tick 0, in SI. Metrics and claims read nothing else."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

Reals = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]


class Trace(NamedTuple):
    """Row n is the state at sample n and the command that answers it. Links in the order rotate, down/up, out/in."""

    tick: Integers  # (n,) 0 = the reference starts
    t_s: Reals  # (n,) since tick 0
    q: Reals  # (n, 3) third column in m, as all q
    q_set: Reals  # (n, 3)
    qd: Reals  # (n, 3) estimate by regression
    qd_set: Reals  # (n, 3)
    x_m: Reals  # (n, 3) from the encoders
    x_set_m: Reals  # (n, 3) as modified by the target impedance
    x_nominal_m: Reals  # (n, 3) as the reference has it
    force_n: Reals  # (n,) tared, not averaged
    force_set_n: Reals  # (n,) before any compensation
    current_a: Reals  # (n, 3) commanded to the valves
    mode: Integers  # (n,) of the supervisor
    sample_age_s: Reals  # (n,) age of the answered sample when its command was accepted
    encoder_counts: Integers  # (n, 5)
    force_counts: Integers  # (n,)
    dac_counts: Integers  # (n, 3)


def rows(trace: Trace, chosen: npt.NDArray[np.bool_]) -> Trace:
    """The rows of `trace` where `chosen` (n,) is true."""
    columns: dict[str, Any] = {name: column[chosen] for name, column in trace._asdict().items()}
    return Trace(**columns)


def window(trace: Trace, start_s: float, end_s: float) -> Trace:
    """The rows from `start_s` to `end_s`, both included; views of the same columns, since time only goes forwards."""
    first = int(np.searchsorted(trace.t_s, start_s, side="left"))
    end = int(np.searchsorted(trace.t_s, end_s, side="right"))
    columns: dict[str, Any] = {name: column[first:end] for name, column in trace._asdict().items()}
    return Trace(**columns)
