"""What an operator asks of a cell that is up: emergency stop, stop, reset, recovery, other parameters."""

import json
import time
from collections.abc import Mapping
from typing import Any

from hydrohil.cell.emergency import outcome
from hydrohil.cell.processes import CellError, NotConfirmedError, RefusedError, ask, statuses
from hydrohil.shared.contract.assignments import text_of
from hydrohil.shared.transport.bus import Bus

_SAMPLES_S = 0.05  # the supervisor judges an emergency stop by what the next samples say of the gate
_ANSWER_S = 10.0  # a stiffness is examined between the samples, along the whole reference
_ESTOP_S = 1.0
_HOLD_S = 0.1  # a request this often keeps a recovery moving


def estop(bus: Bus) -> str:
    """Stop at gate and supervisor; either alone suffices. Returns what the plant confirms, in words.

    Raises NotConfirmedError unless the plant reports zero current, and reads it back at the D/A where that is possible.
    """
    at_gate = bus.ask("plant", "estop", {}, _ESTOP_S)
    bus.ask("supervisor", "estop", {}, _ESTOP_S)
    confirmed, words = outcome(at_gate)
    if not confirmed:
        raise NotConfirmedError(words)
    return words


def stop(bus: Bus) -> None:
    """End the trial and disarm. Raises CellError."""
    ask(bus, "supervisor", "stop")


def reset(bus: Bus) -> None:
    """Leave TRIPPED; no valve moves. Raises RefusedError while the cause stands, CellError."""
    ask(bus, "plant", "reset")
    time.sleep(_SAMPLES_S)
    ask(bus, "supervisor", "reset")


def recover(bus: Bus, seconds: float) -> str:
    """Move slowly in the direction that unloads what tripped, for `seconds`; returns the supervisor's words afterwards.

    Hold to run: an exception in between, such as Ctrl-C, releases at once. Raises RefusedError, CellError.
    """
    until = time.monotonic() + seconds
    try:
        while time.monotonic() < until:
            ask(bus, "supervisor", "recover", 1.0)
            time.sleep(_HOLD_S)
    finally:
        bus.ask("supervisor", "release", {}, 1.0)
    return str(statuses(bus, ("supervisor",)).get("supervisor", {}).get("words", ""))


def assignments_of(values: Mapping[str, Any]) -> list[str]:
    """`path=value` lines of values by path."""
    return [f"{path}={text_of(value)}" for path, value in values.items()]


def set_parameters(bus: Bus, assignments: list[str]) -> dict[str, Any]:
    """Change parameters of the controller while a trial runs, several as one change; returns the controller's answer.

    `number` is the sample from which they act, `ramp_samples` over how many they move, `changed` lists `path`, `old` and `new`,
    `warnings` what the controller warns of. Raises RefusedError, CellError.
    """
    answer = bus.ask("controller", "parameters", {"set": assignments}, _ANSWER_S)
    if answer is None:
        raise CellError("the controller does not answer: start it (`hydrohil controller`) or see `hydrohil status`")
    if not answer.accepted:
        raise RefusedError(f"refused: {answer.reason}")
    values: dict[str, Any] = json.loads(answer.values)
    return values
