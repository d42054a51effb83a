"""The 3-D scene from the messages: joints from the encoder counts, target and path, the contact force as an arrow."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hydrohil.services.recorder.rows import Rows, Times, selected
from hydrohil.shared.contract.columns import Matrix
from hydrohil.shared.contract.messages import PlantDescription
from hydrohil.shared.machine.description import LINKS, Channel
from hydrohil.shared.machine.unimate import UNIMATE

SCENE_PERIOD_NS = 20_000_000  # 50 poses a second are smooth to the eye
ARROW_M_PER_N = 0.0015  # 100 N are 0.15 m
JOINTS = (*LINKS, "pitch")  # of arm.urdf; encoder channels of these names move it
DEFAULT_PERIOD_NS = 4_500_000
DEFAULT_AXIS, DEFAULT_SIGN = 2, 1.0  # gauge vertical, the plate pushes up

TIP, PATH, TARGET, NOMINAL, FORCE = "scene/tip", "scene/path", "scene/target", "scene/nominal", "scene/force"


class Machine(NamedTuple):
    """The part of the plant's description that the scene needs."""

    encoders: tuple[Channel, ...] = UNIMATE.encoders
    period_ns: int = DEFAULT_PERIOD_NS
    force_axis: int = DEFAULT_AXIS
    force_sign: float = DEFAULT_SIGN


def machine(description: PlantDescription | None) -> Machine:
    """The machine that `plant/description` describes; the Unimate until it has come."""
    if description is None:
        return Machine()
    return Machine(description.machine.encoders, description.sample_period_ns, description.force_axis, description.force_sign)


def shown_rows(times: Times, period_ns: int) -> NDArray[np.bool_]:
    """Rows that the scene shows: every so-many-th sample."""
    step = max(1, round(SCENE_PERIOD_NS / max(1, period_ns)))
    mask: NDArray[np.bool_] = times.samples % step == 0
    return mask


def joint_rows(names: tuple[str, ...], matrix: Matrix, times: Times, of: Machine) -> list[Rows]:
    """Joint positions from the encoder counts: rad, m."""
    mask = shown_rows(times, of.period_ns)
    found = []
    for i, channel in enumerate(of.encoders):
        column = f"encoder_counts[{i}]"
        if channel.name in JOINTS and column in names and mask.any():
            counts = matrix[mask, names.index(column)]
            found.append(
                Rows(f"scene/joint/{channel.name}", "joint", selected(times, mask), counts * channel.scale + channel.offset)
            )
    return found


def _vectors(names: tuple[str, ...], matrix: Matrix, field: str) -> Matrix:
    return matrix[:, [names.index(f"{field}[{i}]") for i in range(3)]]


def tip_rows(names: tuple[str, ...], matrix: Matrix, times: Times, of: Machine) -> list[Rows]:
    """Tip, set-point, nominal position and the environment's push on the tool, from the controller's state."""
    x, target, nominal = (_vectors(names, matrix, field) for field in ("x_m", "x_set_m", "x_nominal_m"))
    force = matrix[:, names.index("force_mean_n")]
    finite = np.isfinite(x).all(1) & np.isfinite(target).all(1) & np.isfinite(nominal).all(1) & np.isfinite(force)
    mask = shown_rows(times, of.period_ns) & finite
    if not mask.any():
        return []
    at = selected(times, mask)
    push = np.zeros((len(matrix), 3))
    push[:, of.force_axis] = np.maximum(force, 0.0) * of.force_sign * ARROW_M_PER_N
    arrows = np.stack((x - push, push), 1)[mask]  # the head touches the tip
    points = ((TIP, x), (PATH, x), (TARGET, target), (NOMINAL, nominal))
    return [Rows(entity, "points", at, values[mask]) for entity, values in points] + [Rows(FORCE, "arrows", at, arrows)]
