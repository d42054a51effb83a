"""The rows that a trial on the local clock leaves, one a sample."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import ControllerState, GroundTruth, LinkCounts, Permit, Sample

Reals = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]


class Columns(NamedTuple):
    """The columns of a trace, and what only an emulator knows: (n,), (n, 3) of the links or axes, or (n, 5) of the encoders."""

    tick: Integers
    time_ns: Integers  # since tick 0
    q: Reals
    q_set: Reals
    qd: Reals
    qd_set: Reals
    x_m: Reals
    x_set_m: Reals
    x_nominal_m: Reals
    force_n: Reals
    force_set_n: Reals
    current_a: Reals
    mode: Integers
    encoder_counts: Integers
    force_counts: Integers
    dac_counts: Integers
    clamped: Integers
    boosted: Integers
    pressure_a_pa: Reals
    pressure_b_pa: Reals
    true_q: Reals
    contact_force_n: Reals


_LINKS = ("q", "q_set", "qd", "qd_set", "x_m", "x_set_m", "x_nominal_m", "current_a")
_LINKS_TOO = ("dac_counts", "boosted", "pressure_a_pa", "pressure_b_pa", "true_q")
_WIDTHS = {"encoder_counts": (5,)} | dict.fromkeys((*_LINKS, *_LINKS_TOO), (3,))


def columns(count: int) -> Columns:
    """Rows of zeros for `count` samples."""

    def column(name: str, kind: object) -> Any:
        return np.zeros((count, *_WIDTHS.get(name, ())), dtype=np.int64 if kind is Integers else np.float64)

    return Columns(*(column(name, kind) for name, kind in Columns.__annotations__.items()))


@kernel
def write_plant(out: Columns, row: int, sample: Sample, ground_truth: GroundTruth) -> None:
    """What the plant measured at the sample of `row`, and what is true there."""
    out.tick[row] = sample.tick
    out.time_ns[row] = sample.trial_time_ns
    out.force_counts[row] = sample.force_counts
    out.contact_force_n[row] = ground_truth.contact_force_n
    for k in range(5):
        out.encoder_counts[row, k] = sample.encoder_counts[k]
    for k in range(3):
        out.pressure_a_pa[row, k] = ground_truth.pressure_a_pa[k]
        out.pressure_b_pa[row, k] = ground_truth.pressure_b_pa[k]
        out.true_q[row, k] = ground_truth.q[k]


@kernel
def write_answers(out: Columns, row: int, codes: LinkCounts, state: ControllerState, permit: Permit) -> None:
    """What controller and supervisor answered to the sample of `row`."""
    out.force_n[row] = state.force_n
    out.force_set_n[row] = state.force_set_n
    out.mode[row] = permit.mode
    out.clamped[row] = state.clamped
    for k in range(3):
        out.q[row, k] = state.q[k]
        out.q_set[row, k] = state.q_set[k]
        out.qd[row, k] = state.qd[k]
        out.qd_set[row, k] = state.qd_set[k]
        out.x_m[row, k] = state.x_m[k]
        out.x_set_m[row, k] = state.x_set_m[k]
        out.x_nominal_m[row, k] = state.x_nominal_m[k]
        out.current_a[row, k] = state.current_a[k]
        out.dac_counts[row, k] = codes[k]
        out.boosted[row, k] = state.boosted[k]
