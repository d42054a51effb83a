"""Maps and distributions of a campaign's columns, as PNG files."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hydrohil.campaign.axis import values
from hydrohil.campaign.borders import border_lines
from hydrohil.campaign.campaign import Picture, Plan
from hydrohil.campaign.work import COMPLETED
from hydrohil.claims.trace import Reals

SIZE_IN, DOTS_PER_IN = (7.2, 5.0), 150
MISSING = "#d0d0d0"  # not determined
BORDERS = ("#e0701a", "#d1495b", "#8e6bbf")


def draw_all(plan: Plan, table: pa.Table, folder: Path) -> list[Path]:
    """Every picture of the campaign; returns where they are. Raises OSError."""
    files = []
    for name, picture in plan.campaign.pictures.items():
        canvas = Figure(figsize=SIZE_IN, layout="constrained")
        axes = canvas.subplots()
        _KINDS[picture.kind](axes, plan, picture, table)
        axes.set_title(picture.title or f"{plan.campaign.title}: {name}", loc="left", fontsize=10.0)
        files.append(folder / f"{plan.campaign.name}-{name}.png")
        canvas.savefig(files[-1], dpi=DOTS_PER_IN)
    return files


def numbers(table: pa.Table, name: str) -> Reals:
    """(n,) a column as floats; NaN where it is null."""
    column: Reals = np.asarray(table.column(name).cast(pa.float64()).to_numpy(), dtype=np.float64)
    return column


def label(plan: Plan, name: str) -> str:
    """A column with its unit, where that is not in the name."""
    measure = plan.campaign.metrics.get(name)
    return name if measure is None or measure.unit == "1" else f"{name} ({measure.unit})"


def grid_of(plan: Plan, picture: Picture, table: pa.Table) -> tuple[Reals, Reals, Reals]:
    """x (m,), y (n,) and the mean of the column over everything else, (n, m); NaN where no trial determines it."""
    x, y = (np.array(values(plan.campaign.sweep[name]), dtype=np.float64) for name in (picture.x, picture.y))
    x, y = np.sort(x), np.sort(y)
    column = numbers(table, picture.of)
    determined = np.isfinite(column)
    cell = tuple(np.searchsorted(known, numbers(table, name))[determined] for name, known in ((picture.y, y), (picture.x, x)))
    total, count = np.zeros((len(y), len(x))), np.zeros((len(y), len(x)))
    np.add.at(total, cell, column[determined])
    np.add.at(count, cell, 1.0)
    return x, y, np.divide(total, count, out=np.full_like(total, np.nan), where=count > 0.0)


def edges(centres: Reals, log: bool) -> Reals:
    """(n + 1,) borders of the cells about two or more ascending `centres` (n,): halfway, on a log scale by the logarithm."""
    scale = np.log(centres) if log else centres
    halfway = (scale[1:] + scale[:-1]) / 2.0
    borders = np.concatenate(([2.0 * scale[0] - halfway[0]], halfway, [2.0 * scale[-1] - halfway[-1]]))
    on_the_axis: Reals = np.exp(borders) if log else borders
    return on_the_axis


def _is_log(plan: Plan, name: str) -> bool:
    grid = plan.campaign.sweep[name].grid
    return grid is not None and grid.scale == "log"


def _map(axes: Axes, plan: Plan, picture: Picture, table: pa.Table) -> None:
    """Colour over two parameters; a cross where a trial did not complete."""
    x, y, mean = grid_of(plan, picture, table)
    axes.set_facecolor(MISSING)
    logs = [_is_log(plan, name) for name in (picture.x, picture.y)]
    mesh = axes.pcolormesh(edges(x, logs[0]), edges(y, logs[1]), mean, cmap="viridis", rasterized=True)
    axes.figure.colorbar(mesh, ax=axes, label=label(plan, picture.of))
    axes.set(xscale="log" if logs[0] else "linear", yscale="log" if logs[1] else "linear")
    axes.set(xlabel=label(plan, picture.x), ylabel=label(plan, picture.y))
    ended = np.array(table.column("ended").to_pylist()) != COMPLETED
    if ended.any():
        at = numbers(table, picture.x)[ended], numbers(table, picture.y)[ended]
        axes.plot(*at, "x", color="#d1495b", markersize=3.0, label="did not complete", linestyle="none")
    if picture.border:
        box = axes.get_xlim(), axes.get_ylim()
        for colour, (words, xs, ys) in zip(BORDERS, border_lines(plan, picture, x, y), strict=False):
            axes.plot(xs, ys, color=colour, linewidth=1.6, label=words)
        axes.set(xlim=box[0], ylim=box[1])
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=8.0, loc="upper left")


def _distribution(axes: Axes, plan: Plan, picture: Picture, table: pa.Table) -> None:
    """Share of trials up to each value, one curve a value of `by`; what is not determined counts, and leaves a curve below 1."""
    groups = table.column(picture.by).to_pylist() if picture.by else [""] * table.num_rows
    column = numbers(table, picture.of)
    for group in dict.fromkeys(groups):
        chosen = column[[one == group for one in groups]]
        known = np.sort(chosen[np.isfinite(chosen)])
        words = f"{picture.by} = {group}, {len(chosen)} trials" if picture.by else f"{len(chosen)} trials"
        missing = len(chosen) - len(known)
        axes.step(known, np.arange(1, len(known) + 1) / max(1, len(chosen)), where="post", label=_with_missing(words, missing))
    axes.set(xlabel=label(plan, picture.of), ylabel="share of the trials", ylim=(0.0, 1.02))
    axes.grid(linewidth=0.4)
    axes.legend(fontsize=8.0)


def _with_missing(words: str, missing: int) -> str:
    return f"{words}, {missing} not determined" if missing else words


_KINDS: dict[str, Callable[[Axes, Plan, Picture, pa.Table], Any]] = {"map": _map, "distribution": _distribution}
