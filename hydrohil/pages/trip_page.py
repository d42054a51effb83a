"""A trip report as one HTML page: its text, and plots of force, tip, joints and valves with the trip marked at time 0."""

from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hydrohil.claims.study import Curve, Panel
from hydrohil.pages.drawing import svg
from hydrohil.pages.panels import Picture
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.machine.description import LINK_TITLES
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.trips import formatting
from hydrohil.shared.trips.report import Document
from hydrohil.shared.trips.tables import GROUND_TRUTH, PERMIT, SAMPLE, STATE, Table, row_of
from hydrohil.shared.units import NS_PER_S

_AXES = ("x", "y", "z")
_X = "time since the trip in s"
_STYLE = (
    "body{margin:0 auto;padding:1rem;max-width:60rem;font:16px/1.45 system-ui,sans-serif}"
    ":root{color-scheme:light dark}pre{overflow-x:auto;font-size:.8rem}svg{width:100%;height:auto}"
)

Reals = NDArray[np.float64]


def page(document: Document) -> str:
    """The page's text; nothing is loaded from elsewhere."""
    drawn = "\n".join(svg(Picture(p.y_label, (p,)), f"trip-{k}", f"{p.y_label}, {_X}") for k, p in enumerate(panels(document)))
    text = "\n".join(formatting.lines(document)[1:])
    title = f"Trip: {document['cause']}, {document['utc']}"
    head = f'<meta charset="utf-8"/><title>{escape(title)}</title><style>{_STYLE}</style>'
    foot = f"cell {escape(document['cell'])}, run {document['run']}, experiment {escape(document['experiment'])}"
    body = f"<h1>{escape(title)}</h1>\n<p>{escape(document['sentence'])}</p>\n{drawn}\n<pre>{escape(text)}</pre>\n<p>{foot}</p>"
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head>\n<body>{body}</body></html>\n'


def panels(document: Document) -> list[Panel]:
    """Stacked panels over the time since the trip; a signal that is not in the report is left out."""
    signals = document["signals"]
    times = _times(signals[SAMPLE], document["sample"])
    rows = (
        ("force in N", _forces(signals)),
        ("tip moved, mm", _moved(signals, document["sample"])),
        ("joints moved, deg, cm", _joints(signals, document["sample"])),
        ("valves in mA", _valves(signals)),
    )
    found = []
    for label, named in rows:
        curves = tuple(curve for name, table, y in named if (curve := _curve(name, table, y, times)) is not None)
        if curves:
            found.append(Panel(_X, label, curves))
    return found


def _times(samples: Table, number: int) -> dict[int, float]:
    """Time of each sample since the trip's, by the plant; of a rollout by its trial."""
    column = samples.get("echo_time_ns") or samples["trial_time_ns"]
    at = row_of(samples, number)
    zero = column[-1 if at is None else at]
    return {n: (t - zero) / NS_PER_S for n, t in zip(samples["number"], column, strict=True) if t is not None}


def _curve(name: str, table: Table, y: Reals | None, times: dict[int, float]) -> Curve | None:
    numbers = table.get("number") or table.get("echo_number") or []
    if y is None or not len(y):
        return None
    known = [i for i, n in enumerate(numbers) if n in times and np.isfinite(y[i])]
    return Curve(name, np.array([times[numbers[i]] for i in known]), y[known]) if known else None


def _column(table: Table, name: str) -> Reals | None:
    return np.array(table[name], dtype=np.float64) if name in table else None


def _scaled(table: Table, name: str, factor: float, zero_row: int | None = None) -> Reals | None:
    values = _column(table, name)
    if values is None:
        return None
    zero = 0.0 if zero_row is None else float(values[zero_row])
    scaled: Reals = (values - zero) * factor
    return scaled


def _forces(signals: Any) -> list[tuple[str, Table, Reals | None]]:
    samples, state, ground_truth, permits = (signals.get(topic, {}) for topic in (SAMPLE, STATE, GROUND_TRUTH, PERMIT))
    return [
        ("raw reading", samples, _scaled(samples, "force_counts", UNIMATE.force.scale)),
        ("tared", state, _column(state, "force_n")),
        ("true contact", ground_truth, _column(ground_truth, "contact_force_n")),
        ("supervisor's limit", permits, _column(permits, "force_limit_n")),
    ]


def _moved(signals: Any, number: int) -> list[tuple[str, Table, Reals | None]]:
    state = signals.get(STATE, {})
    at = row_of(state, number)
    return [] if at is None else [(axis, state, _scaled(state, f"x_m[{k}]", 1e3, at)) for k, axis in enumerate(_AXES)]


def _joints(signals: Any, number: int) -> list[tuple[str, Table, Reals | None]]:
    state = signals.get(STATE, {})
    at, factors = row_of(state, number), (np.rad2deg(1.0), np.rad2deg(1.0), 1e2)
    if at is None:
        return []
    return [(link, state, _scaled(state, f"q[{k}]", float(factors[k]), at)) for k, link in enumerate(LINK_TITLES)]


def _valves(signals: Any) -> list[tuple[str, Table, Reals | None]]:
    samples, found = signals.get(SAMPLE, {}), []
    for k, (link, converter) in enumerate(zip(LINK_TITLES, UNIMATE.converters, strict=True)):
        codes = _column(samples, f"dac_counts[{k}]")
        found.append((link, samples, None if codes is None else (codes - ZERO_CODE) * converter.scale * 1e3))
    return found
