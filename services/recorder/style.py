"""Names, colours and widths of the curves; colours of the states. Rerun's automatic colours are hard to distinguish."""

from typing import NamedTuple

import numpy as np
import rerun as rr

from hydrohil.services.recorder.state_timeline import STATE_TIMELINES
from hydrohil.shared.contract.columns import Figure, figures
from hydrohil.shared.contract.messages import ControllerState, GroundTruth, Permit, Sample
from hydrohil.shared.machine.description import Channel
from hydrohil.shared.machine.unimate import UNIMATE

ROTATE, DOWN_UP, OUT_IN = 0x5B9BFFFF, 0x4FC878FF, 0xFFA24AFF
MEASURED, MEAN, SET, NOMINAL, LIMIT = 0x4C78A8FF, 0x62D0FFFF, 0xF2F2F2FF, 0x9A8CFFFF, 0xE05050FF
FADED = 0.55
MISSING, ANSWER, GATE, COMPUTE = 0xFF5050FF, 0x62D0FFFF, 0xFFA24AFF, 0x4FC878FF


class Style(NamedTuple):
    """How the curves of one entity are drawn."""

    names: tuple[str, ...]
    colors: tuple[int, ...]
    widths: tuple[float, ...]
    stepped: bool = False


def faded(color: int) -> int:
    """The same hue, darker: for a set-point beside its measured value."""
    red, green, blue = ((color >> shift & 0xFF) for shift in (24, 16, 8))
    return int(red * FADED) << 24 | int(green * FADED) << 16 | int(blue * FADED) << 8 | 0xFF


LINK_COLORS = (ROTATE, DOWN_UP, OUT_IN)
_THIN, _LINE, _BOLD = 1.0, 1.5, 2.0
_POSITION = ((NOMINAL, SET, MEAN), (_LINE, _LINE, _BOLD))
_PAIRS = tuple(c for color in LINK_COLORS for c in (color, faded(color)))

DRAWN: dict[str, tuple[tuple[int, ...], tuple[float, ...]]] = {
    "figure/force": ((MEASURED, MEAN, SET), (_THIN, _BOLD, _LINE)),
    "figure/contact_force": ((DOWN_UP,), (_THIN,)),
    "figure/force_limit": ((LIMIT,), (_LINE,)),
    "figure/position/x": _POSITION,
    "figure/position/y": _POSITION,
    "figure/position/z": _POSITION,
    "figure/error/angle": (LINK_COLORS[:2], (_LINE, _LINE)),
    "figure/error/extension": (LINK_COLORS[2:], (_LINE,)),
    "figure/velocity/angle": ((faded(ROTATE), faded(DOWN_UP), ROTATE, DOWN_UP), (_LINE, _LINE, _LINE, _LINE)),
    "figure/velocity/extension": ((faded(OUT_IN), OUT_IN), (_LINE, _LINE)),
    "figure/set_current": (LINK_COLORS, (_THIN,) * 3),
    "figure/integral": (LINK_COLORS, (_LINE,) * 3),
    "figure/valve": (LINK_COLORS, (_LINE,) * 3),
    "figure/pressure": (_PAIRS, (_LINE,) * 6),
    "figure/environment": ((OUT_IN,), (_LINE,)),
    "figure/latency/gate": ((GATE,), (_LINE,)),
    "figure/latency/compute": ((COMPUTE,), (_LINE,)),
}
PLAIN: dict[str, Style] = {
    "figure/latency/answer": Style(("command after sample, at the recorder",), (ANSWER,), (_LINE,)),
}


def style_of(figure: Figure) -> Style:
    """How a figure is drawn; one that the table does not know is drawn in the links' colours."""
    count = len(figure.curves)
    colors, widths = DRAWN.get(figure.entity, (LINK_COLORS, (_LINE,)))
    names = tuple(curve.name for curve in figure.curves)
    return Style(names, (colors * count)[:count], (widths * count)[:count], figure.stepped)


def styles(converters: tuple[Channel, ...] = UNIMATE.converters) -> dict[str, Style]:
    """Every figure's style by entity."""
    every = [figure for message in (Sample, ControllerState, GroundTruth, Permit) for figure in figures(message, converters)]
    return {figure.entity: style_of(figure) for figure in every} | PLAIN


def log_styles(stream: rr.RecordingStream, converters: tuple[Channel, ...] = UNIMATE.converters) -> None:
    """Write names and colours of curves and states, once for the whole recording."""
    for entity, style in styles(converters).items():
        mode = "StepAfter" if style.stepped else None
        lines = rr.SeriesLines(
            names=style.names, colors=np.array(style.colors, np.uint32), widths=style.widths, interpolation_mode=mode
        )
        stream.log(entity, lines, static=True)
    for timeline in (timeline for state_timelines in STATE_TIMELINES.values() for timeline in state_timelines):
        texts, colors = zip(*((label.text, label.color) for label in timeline.labels.values()), strict=True)
        stream.log(
            timeline.entity,
            rr.StateConfiguration(values=list(texts), labels=list(texts), colors=np.array(colors, np.uint32)),
            static=True,
        )
