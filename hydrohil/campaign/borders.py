"""Predicted borders, as lines over a map of simulated trials."""

from typing import NamedTuple

import numpy as np

from hydrohil.campaign.axis import Axis
from hydrohil.campaign.campaign import Campaign, Picture, Plan
from hydrohil.claims.trace import Reals
from hydrohil.experiment.criteria import LEAST, MOST, least_stable_n_per_m

TARGET, ENVIRONMENT = "controller.impedance.stiffness_n_per_m", "plant.environment.stiffness_n_per_m"
POINTS = 200
BORDERS = (("cannot cycle above: k = 2 k_eff", LEAST, MOST), ("must cycle below: k = k_eff / 2", MOST, LEAST))


class Line(NamedTuple):
    """One border: its label and its points."""

    words: str
    x: Reals
    y: Reals


def leads_to(name: str, axis: Axis, path: str) -> bool:
    """Whether the axis' value is the field at `path`."""
    return (axis.sets or {name: "value"}).get(path, "").strip() == "value"


def border_problems(campaign: Campaign, picture: Picture) -> list[str]:
    """What keeps the border from being drawn."""
    shown = {name: campaign.sweep[name] for name in (picture.x, picture.y) if name in campaign.sweep}
    return [
        f"border {picture.border!r} needs {path} on one of the map's axes"
        for path in (TARGET, ENVIRONMENT)
        if not any(leads_to(name, axis, path) for name, axis in shown.items())
    ]


def border_lines(plan: Plan, picture: Picture, x: Reals, y: Reals) -> list[Line]:
    """Target stiffness from which on a limit cycle cannot be, and up to which it must be, by the plate's (thesis 7.1)."""
    gauge = plan.base.plant.machine.sensor_stiffness_n_per_m
    plate_is_x = leads_to(picture.x, plan.campaign.sweep[picture.x], ENVIRONMENT)
    known = x if plate_is_x else y
    plate, lines = np.geomspace(known[0], known[-1], POINTS), []
    for words, alpha, beta in BORDERS:
        border = np.array([least_stable_n_per_m(k * gauge / (k + gauge), alpha, beta) for k in plate])
        lines.append(Line(words, plate, border) if plate_is_x else Line(words, border, plate))
    return lines
