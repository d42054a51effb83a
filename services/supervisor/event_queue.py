"""Requests that act at a sample: one a step, an emergency stop before all others."""

from hydrohil.services.supervisor.modes import Event
from hydrohil.shared.contract.messages import Mode
from hydrohil.shared.transport.requests import Request

MOST_WAITING = 64  # a third of a second of events, one a sample
EVENTS = {
    "arm": Event.ARM,
    "start": Event.START,
    "stop": Event.STOP,
    "estop": Event.ESTOP,
    "reset": Event.RESET,
    "recover": Event.HOLD_RECOVER,
    "release": Event.RELEASE,
}
_GRANTED_IN = {
    Event.ARM: (Mode.ARMED,),
    Event.START: (Mode.RUNNING,),
    Event.STOP: (Mode.DISARMED, Mode.TRIPPED),
    Event.ESTOP: (Mode.TRIPPED,),
    Event.RESET: (Mode.DISARMED,),
    Event.HOLD_RECOVER: (Mode.RECOVER,),
    Event.RELEASE: (Mode.TRIPPED,),
}


def granted(event: Event, mode: Mode) -> bool:
    """Whether the mode after the step is the one that the event asked for."""
    return mode in _GRANTED_IN[event]


class EventQueue:
    """Events with the requests that wait for their answer."""

    def __init__(self) -> None:
        """No event waits."""
        self._waiting: list[tuple[Event, Request]] = []

    def __len__(self) -> int:
        """How many wait."""
        return len(self._waiting)

    def put(self, event: Event, request: Request) -> None:
        """Put an event last in the queue, or first if it is an emergency stop."""
        self._waiting.insert(0 if event == Event.ESTOP else len(self._waiting), (event, request))

    def next(self) -> tuple[Event, Request | None]:
        """The event of this step; NOTHING and None without one."""
        return self._waiting.pop(0) if self._waiting else (Event.NOTHING, None)

    def take_resets(self) -> list[Request]:
        """Take every waiting reset out of the queue, so that it has no effect."""
        resets = [request for event, request in self._waiting if event == Event.RESET]
        self._waiting = [(event, request) for event, request in self._waiting if event != Event.RESET]
        return resets
