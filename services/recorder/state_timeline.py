"""States over time: which column of which message, and the label of each number. A state is written when it changes."""

from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hydrohil.shared.contract.messages import ControllerState, GateCause, GateState, GroundTruth, Mode, Permit, Sample, TripCause
from hydrohil.shared.machine.description import LINKS

GREY, GREEN, AMBER, RED, BLUE, DIM = 0x6B7280FF, 0x2FA866FF, 0xE0A030FF, 0xD64545FF, 0x3F7FD0FF, 0x30343CFF


class Label(NamedTuple):
    """Text and colour (RGBA) of a number."""

    text: str
    color: int


class StateTimeline(NamedTuple):
    """One state over time: entity, column of the message, label of each number."""

    entity: str
    title: str
    column: str
    labels: dict[int, Label]

    def text(self, value: float) -> str:
        """Label of a number; one that is not in the table is shown as it is."""
        known = self.labels.get(int(value)) if value == value else None
        return known.text if known else f"{value:g}"


def _words(member: IntEnum) -> str:
    return member.name.lower().replace("_", " ")


def _named(members: type[IntEnum], colors: dict[int, int], other: int) -> dict[int, Label]:
    return {int(m): Label(_words(m), colors.get(int(m), other)) for m in members}


def _flag(on: str, off: str, color: int) -> dict[int, Label]:
    return {0: Label(off, DIM), 1: Label(on, color)}


_MODES = {Mode.ARMED: BLUE, Mode.RUNNING: GREEN, Mode.TRIPPED: RED, Mode.RECOVER: AMBER}
_GATES = {GateState.OPEN: GREEN, GateState.REVOKED: RED, GateState.RECOVERING: AMBER}

STATE_TIMELINES: dict[type, tuple[StateTimeline, ...]] = {
    Permit: (
        StateTimeline("state/1_supervisor", "supervisor", "mode", _named(Mode, {int(k): v for k, v in _MODES.items()}, GREY)),
        StateTimeline("state/2_trip", "trip", "cause", _named(TripCause, {0: DIM}, RED)),
    ),
    Sample: (
        StateTimeline("state/3_gate", "gate", "gate", _named(GateState, {int(k): v for k, v in _GATES.items()}, GREY)),
        StateTimeline("state/4_gate_cause", "gate cause", "gate_cause", _named(GateCause, {0: DIM}, AMBER)),
    ),
    ControllerState: (
        StateTimeline("state/5_envelope", "envelope", "clamped", _flag("clamped", "free", AMBER)),
        *(
            StateTimeline(f"state/6_boost_{n}", f"boost {n}", f"boosted[{i}]", _flag("boost", "off", BLUE))
            for i, n in enumerate(LINKS)
        ),
    ),
    GroundTruth: tuple(
        StateTimeline(f"state/7_stuck_{n}", f"stuck {n}", f"sticking[{i}]", _flag("stuck", "sliding", AMBER))
        for i, n in enumerate(LINKS)
    ),
}


def changes(values: NDArray[np.float64], before: float | None) -> NDArray[np.int64]:
    """Rows at which the value differs from the one before it; `before` None = the first row counts as one."""
    if not len(values):
        return np.empty(0, np.int64)
    changed = np.empty(len(values), np.bool_)
    changed[0] = before is None or values[0] != before
    changed[1:] = values[1:] != values[:-1]
    return np.flatnonzero(changed).astype(np.int64)


def state_timelines(message: Any) -> tuple[StateTimeline, ...]:
    """State timelines drawn from a message class."""
    return STATE_TIMELINES.get(message, ())
