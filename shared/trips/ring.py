"""The last seconds of every topic, and when they hold a trip with what came after it. Pure.

A trip is a permit whose mode becomes TRIPPED, or a cut of the gate. Permit and cut of one trip give one report.
"""

from collections import defaultdict, deque
from typing import Any, NamedTuple

from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import (
    GateCause,
    GateEvent,
    GateState,
    LinkStats,
    Mode,
    ParameterEvent,
    Permit,
    PlantDescription,
    Sample,
)
from hydrohil.shared.units import NS_PER_S

KEPT_NS = 10 * NS_PER_S  # before the trip, by the samples' own time
_SLACK_NS = NS_PER_S  # a topic that is read after another
AFTER_NS = NS_PER_S // 2  # after it: the zero, and the machine's coming to rest
PATIENCE_NS = NS_PER_S  # on the receiver's clock, for a plant that has ended and sends no samples after its trip
_CHANGES = 256  # of a trial's parameters: the newest
_DEEPEST = 16_384  # messages a topic, whatever their times say: 10 s at 1 kHz, and what comes after
_EXAMINED = (Sample, Permit, GateEvent)  # one by one; all other messages are only kept


class Caught(NamedTuple):
    """A trip with the messages before and after it."""

    messages: dict[str, list[Received]]
    description: PlantDescription | None
    link_stats_by_receiver: dict[str, LinkStats]  # the newest of each receiver
    changes: tuple[ParameterEvent, ...] = ()  # by hand, since the trial began, however long before


class TripRing:
    """Keeps messages; `caught` returns each trip once."""

    def __init__(self) -> None:
        """No message has come."""
        self.description: PlantDescription | None = None
        self._rings: defaultdict[str, deque[Received]] = defaultdict(lambda: deque(maxlen=_DEEPEST))
        self._link_stats_by_receiver: dict[str, LinkStats] = {}
        self._changes: deque[ParameterEvent] = deque(maxlen=_CHANGES)
        self._plant: int | None = None  # epoch
        self._newest_ns = 0
        self._permit: Received | None = None
        self._tripped_ns: tuple[int, int] | None = None  # sample time and arrival of the trip that waits
        self._done: list[Caught] = []

    def take(self, *messages: Received) -> None:
        """Messages of one topic."""
        topic, kind = messages[0].topic, type(messages[0].body)
        if kind is PlantDescription or kind is LinkStats:
            self._describe(messages[-1])
        elif kind is ParameterEvent:
            self._changes.extend(message.body for message in messages if message.body.by_hand)
        else:
            if kind in _EXAMINED:
                for message in messages:
                    self._take(message)
            else:
                self._rings[topic].extend(messages)
            self._forget(topic)

    def _describe(self, message: Received) -> None:
        if isinstance(message.body, PlantDescription):
            self.description = message.body
        else:
            self._link_stats_by_receiver[message.header.sender] = message.body

    def _take(self, message: Received) -> None:
        body = message.body
        if isinstance(body, Sample):
            self._take_sample_time(message)
        elif isinstance(body, Permit):
            self._take_permit(message, body)
            if body.mode == Mode.DISARMED and self._tripped_ns is None:
                self._changes.clear()
        self._rings[message.topic].append(message)
        if isinstance(body, GateEvent) and body.state == GateState.REVOKED and body.cause != GateCause.REVOKED_ARMING:
            self._trip(message)

    def _forget(self, topic: str) -> None:
        ring = self._rings[topic]
        oldest_ns = (self._newest_ns if self._tripped_ns is None else self._tripped_ns[0]) - KEPT_NS - _SLACK_NS
        while ring and ring[0].header.echo_time_ns < oldest_ns:
            ring.popleft()

    def caught(self, now_ns: int, *, at_once: bool = False) -> list[Caught]:
        """Trips whose following messages are complete, or did not come in time."""
        if self._tripped_ns is not None:
            sample_ns, arrival_ns = self._tripped_ns
            if at_once or self._newest_ns - sample_ns >= AFTER_NS or now_ns - arrival_ns >= PATIENCE_NS:
                self._hand_over()
        done, self._done = self._done, []
        return done

    def _take_sample_time(self, message: Received) -> None:
        """Take the plant's time; another plant counts from its own start."""
        if self._plant is not None and message.header.epoch != self._plant:
            self._hand_over()
            self._rings.clear()
            self._newest_ns = 0
        self._plant = message.header.epoch
        self._newest_ns = max(self._newest_ns, message.body.time_ns)

    def _take_permit(self, message: Received, permit: Permit) -> None:
        before, self._permit = self._permit, message
        if before is None or before.header.epoch != message.header.epoch:
            return
        if permit.mode == Mode.TRIPPED and permit.trip_number != before.body.trip_number:  # a release of RECOVER is the same trip
            self._trip(message)
        elif permit.mode == Mode.DISARMED:
            self._hand_over()

    def _trip(self, message: Received) -> None:
        if self._tripped_ns is None:
            self._tripped_ns = (message.header.echo_time_ns, message.arrival_ns)

    def _hand_over(self) -> None:
        if self._tripped_ns is None:
            return
        self._tripped_ns = None
        messages: dict[str, list[Any]] = {topic: list(ring) for topic, ring in self._rings.items()}
        self._done.append(Caught(messages, self.description, dict(self._link_stats_by_receiver), tuple(self._changes)))
