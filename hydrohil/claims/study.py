"""A figure that is computed, not played: curves in panels, and verdicts on what a source states of them."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from hydrohil.claims.claims import Comparison, Unit, Verdict
from hydrohil.claims.trace import Reals, Trace


class Statement(NamedTuple):
    """What a source says of a computed figure, as a band in `unit`."""

    statement: str
    comparison: Comparison
    unit: Unit
    low: float = 0.0
    high: float = 0.0
    source: str = ""


class Curve(NamedTuple):
    """One line, or with `points` one cloud, of a panel: (n,) each."""

    label: str
    x: Reals
    y: Reals
    points: bool = False


class Panel(NamedTuple):
    """One pair of axes."""

    x_label: str
    y_label: str
    curves: tuple[Curve, ...]
    title: str = ""
    log_x: bool = False
    log_y: bool = False


class Studied(NamedTuple):
    """What a study computes: its panels and its verdicts."""

    panels: tuple[Panel, ...]
    verdicts: tuple[Verdict, ...]


class Study(NamedTuple):
    """A computed figure: `run` is given the traces of `trials`, in that order."""

    name: str
    alias: str
    title: str
    source: str
    run: Callable[[Sequence[Trace]], Studied]
    trials: tuple[str, ...] = ()  # names of experiments
    also: tuple[str, ...] = ()  # other names of the figure in its source
