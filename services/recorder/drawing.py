"""Rows to rerun's columns, and the static parts of a recording: robot model, styles, frames."""

from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import rerun as rr
from rerun.urdf import UrdfTree

from hydrohil.services.recorder import scene
from hydrohil.services.recorder.rows import Rows, Times
from hydrohil.services.recorder.style import log_styles

URDF = Path(__file__).with_name("arm.urdf")
ROOT = "base"  # the robot's root frame: everything in the scene is drawn in it
TRIAL_TIME, SAMPLE = "trial_time", "sample"
_POINTS = {  # radius in m, colour
    scene.TIP: (0.018, 0x62D0FFFF),
    scene.PATH: (0.005, 0xFFA24AFF),
    scene.TARGET: (0.024, 0xF2F2F2FF),
    scene.NOMINAL: (0.014, 0x9A8CFFFF),
}
_ARROW_RADIUS_M, _ARROW_COLOR = 0.012, 0xE05050FF


class Drawn(NamedTuple):
    """Rows as rerun takes them; `times` empty = static, `columns` then is an archetype."""

    entity: str
    times: tuple[Any, ...]
    columns: Any
    rows: int


@cache
def robot() -> UrdfTree:
    """The arm: geometry, axes and limits."""
    return UrdfTree.from_file_path(URDF, entity_path_prefix="scene")


def draw(rows: Rows) -> Drawn:
    """Rows as rerun takes them."""
    if rows.times is None:
        return Drawn(rows.entity, (), _static(rows), 0)
    return Drawn(rows.entity, _shared_time_columns(rows.times), _columns(rows), len(rows.times.samples))


def send(stream: rr.RecordingStream, drawn: Drawn) -> None:
    """Hand rows to a stream."""
    if drawn.times:
        stream.send_columns(drawn.entity, drawn.times, drawn.columns)
    else:
        stream.log(drawn.entity, drawn.columns, static=True)


def log_static(stream: rr.RecordingStream) -> None:
    """Write the static parts: the robot, styles, frames of the scene."""
    robot().log_urdf_to_recording(stream)
    for entity, (radius, color) in _POINTS.items():
        stream.log(entity, rr.CoordinateFrame(ROOT), rr.Points3D.from_fields(radii=radius, colors=color), static=True)
    stream.log(
        scene.FORCE, rr.CoordinateFrame(ROOT), rr.Arrows3D.from_fields(radii=_ARROW_RADIUS_M, colors=_ARROW_COLOR), static=True
    )
    log_styles(stream)


_last: tuple[Times | None, tuple[Any, ...]] = (None, ())


def _shared_time_columns(times: Times) -> tuple[Any, ...]:
    """A topic's entities follow each other with the same times; their columns are computed once."""
    global _last
    if _last[0] is not times:
        _last = (times, _time_columns(times))
    return _last[1]


def _time_columns(times: Times) -> tuple[Any, ...]:
    numbers = rr.TimeColumn(SAMPLE, sequence=times.samples)
    if times.trial_ns is None:
        return (numbers,)
    return rr.TimeColumn(TRIAL_TIME, duration=times.trial_ns.astype("timedelta64[ns]")), numbers


def _columns(rows: Rows) -> Any:
    values = rows.values
    match rows.kind:
        case "scalars":
            return rr.Scalars.columns(scalars=values)
        case "state":
            return rr.StateChange.columns(state=values)
        case "text":
            return rr.TextLog.columns(text=[text for _, text in values], level=[level for level, _ in values])
        case "joint":
            joint = robot().get_joint_by_name(rows.entity.rsplit("/", 1)[-1])
            return joint.compute_transform_columns(values.tolist(), clamp=False)
        case "points":
            return rr.Points3D.columns(positions=values)
        case "arrows":
            return rr.Arrows3D.columns(origins=values[:, 0], vectors=values[:, 1])
    raise ValueError(f"rows of kind {rows.kind!r} need no times")


def _static(rows: Rows) -> Any:
    if rows.kind == "names":
        return rr.SeriesLines(names=list(rows.values))
    if rows.kind == "document":
        return rr.TextDocument(rows.values, media_type=rr.MediaType.MARKDOWN)
    raise ValueError(f"rows of kind {rows.kind!r} need times")
