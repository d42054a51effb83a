"""One HTML page with everything in it: summary, a table a row, reaction times against their bound."""

import math
from typing import Any

import numpy as np
from jinja2 import ChoiceLoader, Environment, PackageLoader

from hydrohil.claims.study import Curve, Panel
from hydrohil.faulttest.report import Report, amount, first_failure, milliseconds
from hydrohil.faulttest.tally import FAILED, HELD, NOT_TRIED, WayResult, counts
from hydrohil.pages.drawing import svg
from hydrohil.pages.panels import Picture
from hydrohil.reproduction import formatting as words

FEWEST = 3  # reactions that make a histogram
BINS = 20
BOUND = "bound"


def page(report: Report) -> str:
    """The page's text."""
    loader = ChoiceLoader([PackageLoader("hydrohil.faulttest", ""), PackageLoader("hydrohil.pages", "")])
    environment = Environment(loader=loader, autoescape=True, trim_blocks=True)
    return environment.get_template("faulttest.html").render(
        report=report,
        counts=counts(report.results),
        HELD=HELD,
        FAILED=FAILED,
        NOT_TRIED=NOT_TRIED,
        milliseconds=milliseconds,
        amount=amount,
        first_failure=first_failure,
        histogram=histogram,
        duration=words.duration,
    )


def histogram(tried: WayResult, key: str) -> str:
    """Reaction times of all trials and their bound, as an SVG element; "" where there are too few."""
    reactions = np.array([1000.0 * t.reaction_s for t in tried.trials if math.isfinite(t.reaction_s)])
    bound_ms = 1000.0 * tried.worst("bound_s")
    if len(reactions) < FEWEST or not math.isfinite(bound_ms):
        return ""
    edges = np.linspace(0.0, 1.05 * max(bound_ms, float(reactions.max())), 5 * BINS + 1)
    number, _ = np.histogram(reactions, edges)
    outline: Any = (np.repeat(edges, 2), np.concatenate(([0.0], np.repeat(number, 2), [0.0])))
    curves = (
        Curve("trials", *outline),
        Curve(BOUND, np.array([bound_ms, bound_ms]), np.array([0.0, float(number.max())])),
    )
    panel = Panel("from the fault to zero current, ms", "trials", curves)
    return svg(Picture("", (panel,)), key, f"Reaction times of {tried.way.words} against their bound")
