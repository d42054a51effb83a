"""What a topic's messages look like in the recording: exact rows, and the curves of the figures in people's units.

Every topic is one entity `topic/<key>` with all its numbers in SI, one column a scalar, names in `column_names`.
The figures are picked from those columns. Pure: numpy only.
"""

from collections.abc import Sequence
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hydrohil.shared.contract.messages import Command, ControllerState, GateEvent, GroundTruth, Permit, Sample
from hydrohil.shared.machine.description import LINK_TITLES, Channel
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.units import A_PER_MA, RAD_PER_DEG

Matrix = NDArray[np.float64]

DEG = 1.0 / RAD_PER_DEG
MM = 1e3
MA = 1.0 / A_PER_MA
MPA = 1e-6
MS = 1e-6  # from ns


class Curve(NamedTuple):
    """One line of a figure: (column - minus) * factor + offset."""

    name: str
    column: str
    factor: float = 1.0
    minus: str = ""
    offset: float = 0.0


class Figure(NamedTuple):
    """Curves that share an entity, and how they are drawn."""

    entity: str
    curves: tuple[Curve, ...]
    stepped: bool = False


def column_names(body: Any, header: Any = None) -> tuple[str, ...]:
    """Name of each scalar of a message; `q[1]` is the second of an array, `header.seq` the frame's number."""
    names = ["header.seq"] if header is not None else []
    for field, value in zip(body._fields, body, strict=True):
        names += [f"{field}[{i}]" for i in range(len(value))] if isinstance(value, tuple) else [field]
    return tuple(names)


def flat_rows(bodies: Sequence[Any], seqs: Sequence[int]) -> Matrix:
    """The scalars of messages of one kind, in the order of `column_names`: (n, columns). Whole numbers are exact below 2^53.

    Arrays of one field all have the same length: that of the message's class, which decoding is strict about.
    """
    columns = [np.array(seqs, np.float64)[:, None]]
    for values in zip(*bodies, strict=True):  # field by field: ten times faster than message by message
        scalars = chain.from_iterable(values) if isinstance(values[0], tuple) else values
        columns.append(np.fromiter(scalars, np.float64).reshape(len(bodies), -1))
    return np.concatenate(columns, 1)


def figure_values(figure: Figure, names: tuple[str, ...], matrix: Matrix) -> Matrix | None:
    """The figure's curves (n, k) from a topic's rows (n, columns); None if the message has no such column."""
    index = {name: i for i, name in enumerate(names)}
    if any(curve.column not in index or (curve.minus and curve.minus not in index) for curve in figure.curves):
        return None
    values = np.empty((len(matrix), len(figure.curves)))
    for k, curve in enumerate(figure.curves):
        column = matrix[:, index[curve.column]]
        values[:, k] = (column - matrix[:, index[curve.minus]] if curve.minus else column) * curve.factor + curve.offset
    return values


def _links(column: str, factor: float, which: tuple[int, ...] = (0, 1, 2), minus: str = "", label: str = "") -> tuple[Curve, ...]:
    return tuple(Curve(f"{LINK_TITLES[i]}{label}", f"{column}[{i}]", factor, f"{minus}[{i}]" if minus else "") for i in which)


ANGLES, EXTENSION = (0, 1), (2,)


def _position(axis: int, name: str) -> Figure:
    curves = (("nominal", "x_nominal_m"), ("set-point", "x_set_m"), ("measured", "x_m"))
    return Figure(f"figure/position/{name}", tuple(Curve(label, f"{column}[{axis}]", MM) for label, column in curves))


STATE_FIGURES = (
    Figure(
        "figure/force",
        (Curve("measured", "force_n"), Curve("mean", "force_mean_n"), Curve("set-point", "force_set_n")),
    ),
    _position(0, "x"),
    _position(1, "y"),
    _position(2, "z"),
    Figure("figure/error/angle", _links("q_set", DEG, ANGLES, "q")),
    Figure("figure/error/extension", _links("q_set", MM, EXTENSION, "q")),
    Figure("figure/velocity/angle", _links("qd_set", DEG, ANGLES, label=" set") + _links("qd", DEG, ANGLES)),
    Figure(
        "figure/velocity/extension",
        _links("qd_set", MM, EXTENSION, label=" set") + _links("qd", MM, EXTENSION),
    ),
    Figure("figure/set_current", _links("current_a", MA), stepped=True),
    Figure("figure/integral", _links("integral_a", MA)),
    Figure("figure/latency/compute", (Curve("controller computes", "compute_ns", MS),)),
)
GROUND_TRUTH_FIGURES = (
    Figure("figure/contact_force", (Curve("contact, true", "contact_force_n"),)),
    Figure(
        "figure/pressure",
        tuple(
            c
            for i in (0, 1, 2)
            for c in (
                Curve(f"{LINK_TITLES[i]} A", f"pressure_a_pa[{i}]", MPA),
                Curve(f"{LINK_TITLES[i]} B", f"pressure_b_pa[{i}]", MPA),
            )
        ),
    ),
    Figure("figure/environment", (Curve("environment", "environment_m", MM),)),
)
PERMIT_FIGURES = (Figure("figure/force_limit", (Curve("supervisor's limit", "force_limit_n"),), stepped=True),)


def sample_figures(converters: tuple[Channel, ...] = UNIMATE.converters) -> tuple[Figure, ...]:
    """Figures of the samples: valve current from the codes in force, by the plant's own converter table."""
    curves = tuple(
        Curve(c.name.replace("_", "/"), f"dac_counts[{i}]", c.scale * MA, "", c.offset * MA) for i, c in enumerate(converters)
    )
    return (
        Figure("figure/valve", curves, stepped=True),
        Figure("figure/latency/gate", (Curve("sample's age when the gate accepted", "command_age_ns", MS),)),
    )


def figures(message: type, converters: tuple[Channel, ...] = UNIMATE.converters) -> tuple[Figure, ...]:
    """Figures drawn from a message."""
    fixed = {
        ControllerState: STATE_FIGURES,
        GroundTruth: GROUND_TRUTH_FIGURES,
        Permit: PERMIT_FIGURES,
        GateEvent: (),
        Command: (),
    }
    return sample_figures(converters) if message is Sample else fixed.get(message, ())
