"""A made-up trial that trips, with the stamps that real frames have; and what a recorder knows of it."""

from collections.abc import Iterator
from functools import cache
from typing import Any

from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_COMMAND, InboxCounts, LinkStats, Mode, TripCause
from hydrohil.shared.trips.report import Document, Origin, trip_report
from hydrohil.shared.trips.ring import Caught, TripRing
from hydrohil.shared.trips.tables import tables
from tests.support.recorder_trial import FIRST_NUMBER, PERIOD_NS, TARE_TICKS, received, trial

TRIP_TICK = 300
TRIP_NUMBER = FIRST_NUMBER + 30 + TARE_TICKS + TRIP_TICK
ORIGIN = Origin("2026-11-22T23:40:00Z", "bench", "the recorder's", 7, "abcd")
COUNTS = InboxCounts(
    topic="controller/command",
    accepted=900,
    lost=2,
    other_run=0,
    link_faults=1,
    epoch_conflicts=0,
    oversized=0,
    malformed=0,
    crc=1,
    version=0,
    schema=0,
    cell=0,
    sender=0,
    epoch=0,
    sequence=0,
)
GATE, SUPERVISOR = "gate", "supervisor"


def stamped(message: Received) -> Received:
    """With the echo of the sample that it is, answers or judges."""
    number = getattr(message.body, "number", message.header.echo_number)
    return message._replace(
        header=message.header._replace(echo_number=number, echo_time_ns=max(0, number - FIRST_NUMBER) * PERIOD_NS)
    )


def tripping(by: str, ticks: int = TRIP_TICK + 200, cause: TripCause = TripCause.FORCE_TARED) -> Iterator[Received]:
    """The trial: the supervisor trips at TRIP_TICK, or the gate cuts there and the supervisor a sample later."""
    return iter(_messages(by, ticks, cause))


@cache
def _messages(by: str, ticks: int, cause: TripCause) -> tuple[Received, ...]:
    return tuple(_tripping(by, ticks, cause))


def _tripping(by: str, ticks: int, cause: TripCause) -> Iterator[Received]:
    latched = TRIP_NUMBER + (by == GATE)
    for message in trial(ticks, trip_tick=TRIP_TICK):
        if message.topic == "plant/gate" and by != GATE:
            continue
        body: Any = message.body
        if message.topic == "plant/sample" and body.number == TRIP_NUMBER:  # what was in force when it was sampled
            body = body._replace(dac_counts=(2048, 2200, 2048), gate=1, gate_cause=0)
        if message.topic == "supervisor/permit":
            trips = message.header.echo_number >= latched
            cause_now = TripCause.GATE_CUT if by == GATE else cause
            why = (int(cause_now), 341.2, 334.1, latched) if trips else (0, 0.0, 0.0, NO_COMMAND)
            mode = int(Mode.TRIPPED if trips else Mode.RUNNING)
            body = body._replace(mode=mode, cause=why[0], measured=why[1], limit=why[2], trip_number=why[3])
        yield stamped(message._replace(body=body))


def caught(messages: Iterator[Received]) -> Caught:
    ring = TripRing()
    for message in messages:
        ring.take(message)
    (found,) = ring.caught(0, at_once=True)
    return found


def report(by: str = SUPERVISOR) -> Document:
    found = caught(tripping(by))
    document = trip_report(tables(found.messages), ORIGIN, found.description, {})
    assert document is not None
    return document


def link_stats(number: int) -> Received:
    return received("plant/link_stats", LinkStats(number, (COUNTS,)), 0, number)
