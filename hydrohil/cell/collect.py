"""Every message of one trial, joined into a trace: verdicts need every tick from plant, controller and supervisor."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from hydrohil.claims.trace import Trace
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_TRIAL, GateState, Mode, TripCause
from hydrohil.shared.contract.topics import TOPICS
from hydrohil.shared.errors import HydrohilError
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.inbox import Inbox
from hydrohil.shared.trips.causes import cut_words, trip_words
from hydrohil.shared.trips.events import change_words
from hydrohil.shared.trips.report import Document
from hydrohil.shared.trips.ring import TripRing
from hydrohil.shared.trips.watcher import document_of, utc_now
from hydrohil.shared.units import NS_PER_S

_FROM_STATE = (
    "q",
    "q_set",
    "qd",
    "qd_set",
    "x_m",
    "x_set_m",
    "x_nominal_m",
    "force_n",
    "force_set_n",
    "current_a",
)
_JOINED = ("plant/sample", "controller/command", "controller/state", "supervisor/permit", "plant/gate")
CHANGED = "controller/parameter_change"
DEPTH = 1 << 20  # frames; an hour at 222 Hz


class GapError(HydrohilError):
    """A tick is missing; without it there is no verdict."""


class Collector:
    """Rings for the loop's topics, from before the trial to after its end."""

    def __init__(self, bus: Bus) -> None:
        """Subscribe, until `close`."""
        self._bus = bus
        self.samples = bus.subscribe("plant/sample", DEPTH)
        self.commands = bus.subscribe("controller/command", DEPTH)
        self.states = bus.subscribe("controller/state", DEPTH)
        self.permits = bus.subscribe("supervisor/permit", DEPTH)
        self.gate_events = bus.subscribe("plant/gate", DEPTH)
        self._others = [bus.subscribe(topic.key, DEPTH) for topic in TOPICS if topic.key not in _JOINED]  # for a trip's report
        self._taken: dict[str, list[Received]] = {}

    def close(self) -> None:
        """Unsubscribe, so that later trials in the same program cost no more. What was received stays."""
        for inbox in (*self._loop, *self._others):
            self._bus.unsubscribe(inbox)

    def trip(self, run: int) -> str:
        """Why this run tripped, in words; "" if it did not. Permits say it: an overloaded cell may answer no request."""
        newest = self.permits.peek()
        if not isinstance(newest, Received) or newest.header.run != run or newest.body.mode != Mode.TRIPPED:
            return ""
        permit = newest.body
        words = trip_words(permit.cause, permit.measured, permit.limit, permit.trip_number)
        return (permit.cause == TripCause.GATE_CUT and self._cut(run)) or words

    def changed(self, run: int) -> tuple[str, ...]:
        """Parameters that were changed by hand in this run, in words."""
        events = (
            m.body for inbox in self._others if inbox.topic.key == CHANGED for m in self._messages(inbox) if m.header.run == run
        )
        return tuple(change_words(event) for event in events if event.by_hand)

    def report(self, cell: str) -> Document | None:
        """The report of the trip that was received, with the messages around it; None if there was none."""
        ring, every = TripRing(), [*self._loop, *self._others]
        for message in sorted((m for inbox in every for m in self._messages(inbox)), key=lambda m: m.arrival_ns):
            ring.take(message)
        caught = ring.caught(0, at_once=True)
        return document_of(caught[-1], utc_now(), cell, "this command's", {}) if caught else None

    @property
    def _loop(self) -> tuple[Inbox, ...]:
        return (self.samples, self.gate_events, self.commands, self.states, self.permits)

    def _messages(self, inbox: Inbox) -> list[Received]:
        """Everything valid that has come on a topic, from the first on."""
        taken = self._taken.setdefault(inbox.topic.key, [])
        taken += inbox.take()
        return taken

    def _cut(self, run: int) -> str:
        """Why the gate cut in this run, in words; "" if it reported no cut."""
        events = (m.body for m in self._messages(self.gate_events) if m.header.run == run)
        event = next((body for body in events if body.state == GateState.REVOKED), None)
        if event is None:
            return ""
        return cut_words(event.cause, event.measured, event.limit, event.number)

    def trace(self, run: int, ticks: int) -> Trace:
        """The trial's rows from tick 0; raises GapError naming the first tick and topic that is missing."""
        samples = [m for m in self._messages(self.samples) if m.header.run == run]
        by_number = {m.body.number: m.body for m in samples}
        commands = _by_echo(self._messages(self.commands), run)
        states = _by_echo(self._messages(self.states), run)
        permits = _by_echo(self._messages(self.permits), run)
        in_trial = sorted((m.body.tick, m.body) for m in samples if m.body.tick != NO_TRIAL and 0 <= m.body.tick < ticks)
        rows = []
        for tick, (found, sample) in enumerate(in_trial):
            if found != tick:
                raise GapError(f"sample of tick {tick} is missing")
            for name, bodies in (("command", commands), ("controller state", states), ("permit", permits)):
                if sample.number not in bodies:
                    raise GapError(f"{name} of tick {tick} is missing")
            number = sample.number
            rows.append((sample, commands[number], states[number], permits[number], by_number.get(number + 1)))
        if not rows:
            raise GapError("no sample of the trial has come")
        return _join(rows)


def _by_echo(messages: Iterable[Received], run: int) -> dict[int, Any]:
    """Newest body that answers each sample."""
    return {m.header.echo_number: m.body for m in messages if m.header.run == run}


def _age_s(number: int, following: Any) -> float:
    """Age of the sample when its command was accepted, as the next sample reports it."""
    if following is None or following.command_number != number:
        return float("nan")
    return float(following.command_age_ns) / NS_PER_S


def _join(rows: list[tuple[Any, Any, Any, Any, Any]]) -> Trace:
    samples, commands, states, permits, _ = zip(*rows, strict=True)
    reals: dict[str, Any] = {name: np.array([getattr(s, name) for s in states], dtype=np.float64) for name in _FROM_STATE}
    whole: dict[str, Any] = {
        name: np.array([getattr(s, name) for s in samples], dtype=np.int64) for name in ("tick", "encoder_counts", "force_counts")
    }
    return Trace(
        t_s=np.array([s.trial_time_ns for s in samples], dtype=np.int64) / NS_PER_S,
        mode=np.array([p.mode for p in permits], dtype=np.int64),
        dac_counts=np.array([c.dac_counts for c in commands], dtype=np.int64),
        sample_age_s=np.array([_age_s(row[0].number, row[4]) for row in rows]),
        **reals,
        **whole,
    )
