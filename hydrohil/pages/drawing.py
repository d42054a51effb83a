"""Panels as SVG for a page that is light or dark, small enough that a hundred fit into one file."""

import io
import re
import textwrap
from collections.abc import Iterable, Mapping
from itertools import cycle
from typing import Any, NamedTuple
from xml.sax.saxutils import quoteattr

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas

from hydrohil.claims.study import Curve, Panel
from hydrohil.pages.curves import thinned
from hydrohil.pages.panels import CONTROL, ERROR, MEASURED, NOMINAL, SET_POINT, SURFACE, Picture

WIDTH_IN, PLANE_IN, EXTRA_IN = 6.4, 4.2, 0.55
LEGEND_LETTERS, LABEL_LETTERS = 80, 24  # that fit into one row, and along one panel
INK = "#808081"  # stands for the page's own colour of text; any grey that no curve has
GRID = "#8080804d"


class Drawing(NamedTuple):
    """An SVG element and what it is called."""

    title: str
    svg: str


class Style(NamedTuple):
    """How a curve is drawn: colours that differ on white and on black."""

    colour: str
    line: str = "-"
    width: float = 1.1


STYLES = {  # each meaning has the same style on every figure
    MEASURED: Style("#2f81d7"),
    SET_POINT: Style("#e0701a", "--"),
    NOMINAL: Style("#8d8d8d", ":", 1.4),
    ERROR: Style("#d1495b"),
    CONTROL: Style("#2a9d6f", width=0.8),
    SURFACE: Style("#a0703c", "-", 2.0),
}
OTHERS = ("#2f81d7", "#e0701a", "#2a9d6f", "#d1495b", "#8e6bbf", "#b08a1e", "#3aa6a6", "#8d8d8d", "#c45fa0", "#6f8f2f")
_RC: dict[Any, Any] = {
    "svg.fonttype": "none",  # text stays text, so that it can be searched and stays sharp
    "font.size": 10.0,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "text.color": INK,
    "legend.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "path.simplify_threshold": 0.2,
}


def svg(picture: Picture, key: str, label: str) -> str:
    """`picture` as an SVG element; `key` makes its names unique on the page, `label` describes it to a screen reader."""
    with matplotlib.rc_context({**_RC, "svg.hashsalt": key}):
        canvas = draw(picture)
        file = io.StringIO()
        canvas.savefig(
            file, format="svg", transparent=True, metadata={"Date": None, "Creator": None, "Type": None, "Format": None}
        )
    return slim(file.getvalue(), key, label)


def draw(picture: Picture) -> Canvas:
    """`picture` on a canvas of its own."""
    panels = picture.panels
    columns = 1 if picture.stacked or picture.plane or len(panels) < 3 else 2
    rows = -(-len(panels) // columns)
    canvas = Canvas(figsize=(WIDTH_IN, EXTRA_IN + _panel_in(picture) * rows), layout="constrained")
    grid = canvas.subplots(rows, columns, squeeze=False, sharex=picture.stacked)
    axes_in_order: list[Axes] = list(grid.flat)
    styles = _styles(panels)
    for number, (axes, panel) in enumerate(zip(axes_in_order, panels, strict=False)):
        _draw_panel(axes, panel, styles)
        axes.set_xlabel(panel.x_label if not picture.stacked or number == len(panels) - 1 else "")
        if picture.plane:
            axes.set_aspect("equal")
        elif picture.stacked:
            axes.margins(x=0.01)
    for empty in axes_in_order[len(panels) :]:
        empty.set_visible(False)
    _legend(canvas, axes_in_order)
    canvas.align_ylabels(axes_in_order[: len(panels)])
    return canvas


def _panel_in(picture: Picture) -> float:
    """Height of a panel: a plane is square, three stand over each other, one stands alone."""
    if picture.plane:
        return PLANE_IN
    return {1: 2.6, 2: 2.1}.get(len(picture.panels), 1.5 if picture.stacked else 1.9)


def _styles(panels: Iterable[Panel]) -> dict[str, Style]:
    """The style of each label, the same in every panel."""
    labels = dict.fromkeys(curve.label for panel in panels for curve in panel.curves)
    others = cycle(OTHERS)
    return {label: STYLES.get(label) or Style(next(others)) for label in labels}


def _draw_panel(axes: Axes, panel: Panel, styles: Mapping[str, Style]) -> None:
    for curve in panel.curves:
        _draw_curve(axes, curve, styles[curve.label])
    axes.set_ylabel(textwrap.fill(panel.y_label, LABEL_LETTERS))
    axes.set_xscale("log" if panel.log_x else "linear")
    axes.set_yscale("log" if panel.log_y else "linear")
    axes.grid(color=GRID, linewidth=0.5)
    if panel.title:
        axes.set_title(panel.title, loc="left", fontsize=10.0)


def _legend(canvas: Canvas, axes_in_order: list[Axes]) -> None:
    """One entry a label, above all panels; a curve that is alone in its panel is named by its axis."""
    lines = [line for axes in axes_in_order if len(axes.get_lines()) > 1 for line in axes.get_lines()]
    entries = {str(line.get_label()): line for line in lines if not str(line.get_label()).startswith("_")}
    if len(entries) > 1:
        columns = max(1, min(len(entries), LEGEND_LETTERS // (4 + max(len(label) for label in entries))))
        look: dict[str, Any] = {"ncols": columns, "frameon": False, "fontsize": 9.0, "borderpad": 0.1}
        canvas.legend([*entries.values()], [*entries], loc="outside upper right", **look)


def _draw_curve(axes: Axes, curve: Curve, style: Style) -> None:
    drawn = thinned(curve)
    look: dict[str, Any] = {"color": style.colour, "label": curve.label}
    if curve.points:
        axes.plot(drawn.x, drawn.y, ".", markersize=4.0, **look)
    else:
        axes.plot(drawn.x, drawn.y, style.line, linewidth=style.width, **look)


def slim(drawn: str, key: str, label: str) -> str:
    """The SVG element alone: tenths of a point, names that are its own, the page's colour and font."""
    element = drawn[drawn.index("<svg") :]
    element = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>", "", element, flags=re.DOTALL)
    used = set(re.findall(r"(?:url\(#|href=\"#)([^\")]+)", element))
    element = re.sub(r' id="([^"]+)"', lambda name: f' id="{key}-{name[1]}"' if name[1] in used else "", element)
    element = re.sub(r'(url\(#|href="#)', rf"\g<1>{key}-", element)
    element = re.sub(r'( d=")([^"]*)', lambda path: path[1] + _short(path[2]), element)
    element = re.sub(r"font: (\d+)(?:\.\d+)?px [^;\"]*", r"font: \1px sans-serif", element)
    name = f'role="img" aria-label={quoteattr(label)}'
    element = re.sub(r'<svg[^>]*viewBox="([^"]*)"[^>]*>', lambda box: f'<svg viewBox="{box[1]}" {name}>', element, count=1)
    return re.sub(r"\n\s*", "\n", element.replace(INK, "currentColor")).replace("xlink:href", "href")


def _short(path: str) -> str:
    """Coordinates of a path with one digit, without line ends."""
    return re.sub(r"\s*\n\s*", "", re.sub(r"-?\d+\.\d+", lambda number: f"{float(number[0]):.1f}", path)).strip()
