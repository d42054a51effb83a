"""Lockstep: verdict n is a function of sample n and of the controller's state n - 1, so a sample waits for that state."""

from itertools import takewhile

from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_COMMAND
from hydrohil.shared.transport.bus import Bus, same_run
from hydrohil.shared.transport.inbox import Inbox


class LockstepQueue:
    """Samples that have come and must not be judged yet."""

    def __init__(self, bus: Bus, states: Inbox) -> None:
        """Nothing waits. A sample that a fault keeps from the controller gets no state; `controller/sample_dropped` names it."""
        self._bus, self._states = bus, states
        self._dropped = bus.subscribe("controller/sample_dropped")
        self.begin()

    def begin(self, first_tick: int | None = None) -> None:
        """Another load; `first_tick` is that of its trial in lockstep, None where the wall clock paces."""
        self._first_tick = first_tick
        self._newest_dropped = NO_COMMAND  # newest sample that a fault kept from the controller
        self._waiting: list[Received] = []

    def due(self, coming: list[Received]) -> list[Received]:
        """Samples to judge now, in order, of those that waited and those that come."""
        self._waiting += coming
        dropped = (message.body.number for message in self._dropped.take() if same_run(message.header, self._bus.run))
        self._newest_dropped = max(self._newest_dropped, *dropped, NO_COMMAND)
        answered = max(
            self._states.number, self._states.arrived(), self._newest_dropped
        )  # a state that a fault holds, or whose sample it took, is not awaited
        due = list(takewhile(lambda sample: sample.body.number - 1 <= answered or not self._waits(sample), self._waiting))
        self._waiting = self._waiting[len(due) :]
        return due

    def _waits(self, sample: Received) -> bool:
        """Whether the plant waited, at the sample before, until the controller had answered."""
        return self._first_tick is not None and bool(sample.body.tick > self._first_tick)
