"""Trials as panels, laid out as in the thesis: force, position and control signal over one time axis; paths in x and z."""

from typing import NamedTuple

import numpy as np

from hydrohil.claims.signals import AXES, ChannelName, control, error, measured, nominal, set_point
from hydrohil.claims.study import Curve, Panel
from hydrohil.claims.trace import Reals, Trace
from hydrohil.experiment.experiment import Experiment
from hydrohil.shared.units import A_PER_MA, RAD_PER_DEG

MEASURED, SET_POINT, NOMINAL, ERROR, CONTROL, SURFACE = (
    "measured",
    "set-point",
    "nominal",
    "error",
    "control signal",
    "plate, unloaded",
)
TIME = "time, s"
LENGTHS = (("mm", 1e-3, 0.02), ("cm", 1e-2, 1.0), ("m", 1.0, np.inf))  # unit, in m, up to this range in m
MOST_STACKED = 4
SAME_M = 1e-6  # a nominal trajectory that the set-point never leaves by more is not drawn


class Picture(NamedTuple):
    """Panels under one title: stacked over a common x axis, or one that maps a plane."""

    title: str
    panels: tuple[Panel, ...]
    stacked: bool = True  # share the x axis
    plane: bool = False  # a length is the same in x and y


def pictures(experiment: Experiment, trace: Trace) -> tuple[Picture, ...]:
    """The plots of one trial."""
    if experiment.controller.target == "joint":
        return (Picture("", joint_history(experiment, trace)),)
    history = Picture("History plot", tip_history(experiment, trace))
    moved = {segment.channel for segment in experiment.reference}
    if {"x", "z"} <= moved:
        return (Picture("Motion plot", (path(experiment, trace),), plane=True), history)
    return (history._replace(title=""),)


def computed(panels: tuple[Panel, ...]) -> tuple[Picture, ...]:
    """The plots of a study: over one x axis where they have the same, otherwise side by side."""
    axes = {(panel.x_label, panel.log_x) for panel in panels}
    return (Picture("", panels, stacked=len(axes) == 1 and len(panels) <= MOST_STACKED),) if panels else ()


def joint_history(experiment: Experiment, trace: Trace) -> tuple[Panel, ...]:
    """Position with its set-point, error, control signal of the link that the reference moves (chapter 4)."""
    link: ChannelName = next((s.channel for s in experiment.reference), "q2")
    unit, size = _length(measured(trace, link)) if link == "q3" else ("deg", RAD_PER_DEG)
    t_s = trace.t_s
    position = (Curve(MEASURED, t_s, measured(trace, link) / size), Curve(SET_POINT, t_s, set_point(trace, link) / size))
    return (
        Panel(TIME, f"joint {link[1]}, {unit}", position),
        Panel(TIME, f"error, {unit}", (Curve(ERROR, t_s, error(trace, link) / size),)),
        _control(trace, link),
    )


def tip_history(experiment: Experiment, trace: Trace) -> tuple[Panel, ...]:
    """Force, position along it and the control signal of the link nearest to that direction (5.1.4)."""
    crate = experiment.plant.environment.kind == "crate"
    axis: ChannelName = "x" if crate else "z"
    force = [Curve(MEASURED, trace.t_s, trace.force_n)]
    if np.any(trace.force_set_n):
        force.append(Curve(SET_POINT, trace.t_s, trace.force_set_n))
    return (Panel(TIME, "force, N", tuple(force)), _position(trace, axis), _control(trace, "q3" if crate else "q2"))


def _position(trace: Trace, axis: ChannelName) -> Panel:
    """Measured, modified and nominal position from where the tool began."""
    column = AXES.index(axis)
    from_m = trace.x_m[0, column]
    unit, size = _length(measured(trace, axis))
    curves = [
        Curve(MEASURED, trace.t_s, (measured(trace, axis) - from_m) / size),
        Curve(SET_POINT, trace.t_s, (set_point(trace, axis) - from_m) / size),
    ]
    if np.ptp(nominal(trace, axis)) > SAME_M and np.max(np.abs(nominal(trace, axis) - set_point(trace, axis))) > SAME_M:
        curves.append(Curve(NOMINAL, trace.t_s, (nominal(trace, axis) - from_m) / size))
    return Panel(TIME, f"position {axis}, {unit}", tuple(curves))


def _control(trace: Trace, link: ChannelName) -> Panel:
    return Panel(TIME, f"control {link[1]}, mA", (Curve(CONTROL, trace.t_s, control(trace, link) / A_PER_MA),))


def path(experiment: Experiment, trace: Trace) -> Panel:
    """The tool's path in the plane of the arm, from where it began."""
    begin_m, cm = trace.x_m[0], 1e-2
    curves = [
        Curve(label, (values[:, 0] - begin_m[0]) / cm, (values[:, 2] - begin_m[2]) / cm)
        for label, values in ((MEASURED, trace.x_m), (SET_POINT, trace.x_set_m), (NOMINAL, trace.x_nominal_m))
    ]
    environment = experiment.plant.environment
    if environment.kind == "plate":
        ends = np.array([min(np.min(c.x) for c in curves), max(np.max(c.x) for c in curves)])
        curves.append(Curve(SURFACE, ends, np.full(2, (environment.surface_m - begin_m[2]) / cm)))
    return Panel("x, cm", "z, cm", tuple(curves))


def _length(values: Reals) -> tuple[str, float]:
    """Unit that suits the range of `values`, and its size in m."""
    reach = float(np.ptp(values))
    return next((unit, size) for unit, size, most in LENGTHS if reach < most)
