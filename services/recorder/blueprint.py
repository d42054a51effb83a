"""The layout of a recording: arm and verdicts, the three plots of the thesis' figures, and diagnostics."""

from typing import Any

import rerun as rr
import rerun.blueprint as rrb

from hydrohil.services.recorder import scene
from hydrohil.services.recorder.drawing import ROOT, SAMPLE, TRIAL_TIME
from hydrohil.services.recorder.state_timeline import state_timelines
from hydrohil.shared.contract.messages import ControllerState, GroundTruth, Permit, Sample

TRAIL_S = 3.0
LIVE_WINDOW_SAMPLES = 2500  # about 11 s at 222 Hz
BACKGROUND = [24, 26, 32]
AXES = ("x", "y", "z")


def layout(force_axis: int = scene.DEFAULT_AXIS, live: bool = False) -> rrb.Blueprint:
    """The layout; live it follows the newest sample in a sliding window."""
    timeline = SAMPLE if live else TRIAL_TIME
    left = rrb.Vertical(_arm(timeline, live), _texts(live), row_shares=[3, 2])
    middle = rrb.Vertical(*_thesis_plots(force_axis, live), _state_timelines(live), row_shares=[3, 3, 3, 2.6])
    right = rrb.Vertical(*_diagnostics(live))
    return rrb.Blueprint(
        rrb.Horizontal(left, middle, right, column_shares=[1.0, 1.35, 1.0]),
        rrb.TimePanel(state="collapsed", timeline=timeline, play_state="following" if live else "paused"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        auto_views=False,
        auto_layout=False,
    )


def _window(timeline: str, back: Any) -> rrb.VisibleTimeRange:
    now = rrb.TimeRangeBoundary.cursor_relative(seq=0) if timeline == SAMPLE else rrb.TimeRangeBoundary.cursor_relative(seconds=0)
    return rrb.VisibleTimeRange(timeline, start=back, end=now)


def _arm(timeline: str, live: bool) -> rrb.Spatial3DView:
    if timeline == SAMPLE:
        back = rrb.TimeRangeBoundary.cursor_relative(seq=-int(TRAIL_S * 1e9 / scene.DEFAULT_PERIOD_NS))
    else:
        back = rrb.TimeRangeBoundary.cursor_relative(seconds=-TRAIL_S)
    return rrb.Spatial3DView(
        origin="/",
        contents=["/scene/**", "/tf_static/**"],
        name="Arm: target, path and the environment's push",
        background=rrb.Background(kind="SolidColor", color=BACKGROUND),
        line_grid=rrb.LineGrid3D(visible=True, spacing=0.5, plane=rr.components.Plane3D.XY.with_distance(-1.0)),
        spatial_information=rrb.SpatialInformation(target_frame=ROOT),
        eye_controls=rrb.EyeControls3D(position=(1.75, -2.35, 0.62), look_target=(0.42, 0.0, -0.3), eye_up=(0, 0, 1)),
        defaults=[rr.Boxes3D.from_fields(fill_mode="solid"), rr.Cylinders3D.from_fields(fill_mode="solid")],
        overrides={f"/{scene.PATH}": rrb.VisibleTimeRanges(_window(timeline, back))},
    )


def _texts(live: bool) -> rrb.Tabs:
    summary = rrb.TextDocumentView(origin="/summary", name="Claims and verdicts")
    machine = rrb.TextDocumentView(origin="/machine", name="Machine")
    trip = rrb.TextDocumentView(origin="/trip", name="Trip")
    events = rrb.TextLogView(origin="/log", name="Events")
    return rrb.Tabs(summary, trip, events, machine, active_tab="Events" if live else "Claims and verdicts")


def _sliding() -> tuple[rrb.TimeRangeBoundary, rrb.TimeRangeBoundary]:
    return rrb.TimeRangeBoundary.cursor_relative(seq=-LIVE_WINDOW_SAMPLES), rrb.TimeRangeBoundary.cursor_relative(seq=0)


def _time_axis(live: bool) -> rrb.TimeAxis:
    return rrb.TimeAxis(view_range=rr.TimeRange(*_sliding())) if live else rrb.TimeAxis(link="LinkToGlobal")


def _plot(name: str, contents: list[str], live: bool, legend: str = "LeftTop") -> rrb.TimeSeriesView:
    options: dict[str, Any] = {}
    if live:  # set both what is drawn and the axis: setting one alone leaves the other at the whole recording
        start, end = _sliding()
        options["time_ranges"] = [rrb.VisibleTimeRange(SAMPLE, start=start, end=end)]
    corner = rrb.PlotLegend(corner=legend, visible=True)
    return rrb.TimeSeriesView(origin="/", contents=contents, name=name, axis_x=_time_axis(live), plot_legend=corner, **options)


def _thesis_plots(force_axis: int, live: bool) -> list[rrb.TimeSeriesView]:
    """Force, position and control signal, one above the other, as every figure of chapter 5 shows them."""
    axis = AXES[force_axis]
    return [
        _plot("Force [N]", ["/figure/force", "/figure/contact_force", "/figure/force_limit"], live),
        _plot(f"Position {axis} [mm]", [f"/figure/position/{axis}"], live, "LeftBottom"),
        _plot("Valve signal [mA]", ["/figure/valve"], live, "LeftBottom"),
    ]


def _state_timelines(live: bool) -> rrb.Tabs:
    """Modes of supervisor and gate, integral and envelope of the law, friction of the links."""
    tabs = (("Modes", (Permit, Sample)), ("Integral and envelope", (ControllerState,)), ("Friction", (GroundTruth,)))
    return rrb.Tabs(*(_state_timeline_view(name, messages, live) for name, messages in tabs), active_tab=0)


def _state_timeline_view(name: str, messages: tuple[type, ...], live: bool) -> rrb.StateTimelineView:
    contents = [f"/{timeline.entity}" for message in messages for timeline in state_timelines(message)]
    return rrb.StateTimelineView(origin="/", contents=contents, name=name, time_view=_time_axis(live))


def _diagnostics(live: bool) -> list[Any]:
    tracking = rrb.Tabs(
        _plot("Tracking error [deg, mm]", ["/figure/error/**"], live),
        _plot("Position x [mm]", ["/figure/position/x"], live),
        _plot("Position y [mm]", ["/figure/position/y"], live),
        _plot("Position z [mm]", ["/figure/position/z"], live),
        active_tab=0,
    )
    speed = rrb.Tabs(
        _plot("Velocity [deg/s]", ["/figure/velocity/angle"], live),
        _plot("Velocity out/in [mm/s]", ["/figure/velocity/extension"], live),
        active_tab=0,
    )
    pressure = rrb.Tabs(
        _plot("Pressure [MPa]", ["/figure/pressure"], live),
        _plot("Set current [mA]", ["/figure/set_current"], live),
        _plot("Integral [mA]", ["/figure/integral"], live),
        _plot("Environment [mm]", ["/figure/environment"], live),
        active_tab=0,
    )
    latency = rrb.Tabs(
        _plot("Latency per hop [ms]", ["/figure/latency/**"], live),
        _plot("Missing messages", ["/missing/**"], live),
        _plot("Frames received and discarded", ["/link_stats/**"], live),
        active_tab=0,
    )
    return [tracking, speed, pressure, latency]
