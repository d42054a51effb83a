"""Lines of a recording's event log: one for each event."""

from typing import Literal, NamedTuple

from hydrohil.shared.contract.codec import Header, Rejected
from hydrohil.shared.contract.messages import (
    NO_COMMAND,
    FaultEvent,
    GateCause,
    GateEvent,
    GateState,
    InboxCounts,
    Mode,
    ParameterEvent,
    Permit,
)
from hydrohil.shared.contract.timeliness import LATE_IN_A_ROW
from hydrohil.shared.trips.causes import cut_happened, trip_words
from hydrohil.shared.trips.gaps import Counted

Level = Literal["INFO", "WARN", "ERROR"]


COUNT_NAMES = InboxCounts._fields[1:]


class Event(NamedTuple):
    """A line of the log."""

    source: str
    level: Level
    text: str


def _word(members: type[Mode] | type[GateState], value: int) -> str:
    return members(value).name.lower().replace("_", " ") if value in set(members) else str(value)


def gate_event(event: GateEvent) -> Event:
    """A decision of the gate."""
    level: Level = "ERROR" if event.state == GateState.REVOKED else "WARN"
    why = "" if event.cause == GateCause.NONE else f": {cut_happened(event.cause, event.measured, event.limit)}"
    return Event("gate", level, f"gate {_word(GateState, event.state)}{why} (sample {event.number})")


def fault_event(event: FaultEvent, service: str) -> Event:
    """A scheduled or injected fault begins or ends."""
    what = f"{event.kind} {event.target}" + (f" {event.value:g}" if event.value else "")
    return Event(service, "WARN", f"fault {'begins' if event.acting else 'ends'}: {what}, sample {event.number}")


def change_words(event: ParameterEvent) -> str:
    """Which parameter was changed, by whom, when, from what to what."""
    who = "by hand" if event.by_hand else "as scheduled"
    ramp = f" over {event.ramp_samples} samples" if event.ramp_samples > 1 else ""
    return f"changed {who} at sample {event.number}: {event.path} {event.old} -> {event.new}{ramp}"


def parameter_event(event: ParameterEvent) -> Event:
    """A parameter that was changed while a trial ran; after a change by hand the experiment no longer says what was run."""
    return Event("controller", "WARN" if event.by_hand else "INFO", change_words(event))


def permit_events(before: Permit | None, now: Permit) -> list[Event]:
    """Changes of mode, trips and announced trials, from one permit to the next."""
    events = []
    if before is None or (before.mode, before.cause) != (now.mode, now.cause):
        events.append(_mode_event(before, now))
    if now.first_sample != NO_COMMAND and (before is None or before.first_sample != now.first_sample):
        ticks = f"{now.tare_ticks} ticks of force bias, then {now.duration_ticks}"
        events.append(Event("supervisor", "INFO", f"trial announced: first sample {now.first_sample}, {ticks}"))
    return events


def _mode_event(before: Permit | None, now: Permit) -> Event:
    if now.mode == Mode.TRIPPED:
        words = trip_words(now.cause, now.measured, now.limit, now.trip_number)
        return Event("supervisor", "ERROR", f"tripped: {words}")
    was = "" if before is None else f"{_word(Mode, before.mode)} -> "
    return Event("supervisor", "INFO", was + _word(Mode, now.mode))


def gap_event(topic: str, header: Header, counted: Counted) -> Event | None:
    """A gap in a publisher's numbers, or its restart."""
    if counted.restarted:
        return Event("recorder", "WARN", f"{header.sender} started anew on {topic}: epoch {header.epoch}")
    if counted.skipped:
        first, last = header.seq - counted.skipped, header.seq - 1
        return Event("recorder", "WARN", f"{counted.skipped} missing on {topic} from {header.sender}: {first} to {last}")
    return None


def link_stats_event(receiver: str, before: InboxCounts | None, now: InboxCounts) -> Event | None:
    """What a receiver lost or discarded since its last report; None for its first report and after its restart."""
    if before is None:
        return None
    grown = {name: getattr(now, name) - getattr(before, name) for name in COUNT_NAMES if name != "accepted"}
    words = ", ".join(f"{by} {name.replace('_', ' ')}" for name, by in grown.items() if by > 0)
    return Event(receiver, "WARN", f"{receiver} of {now.topic}: {words}") if words else None


def late_event(in_a_row: int, number: int) -> Event | None:
    """A warning when more answers in a row than LATE_IN_A_ROW were late or missing; the lease decides when that is a trip."""
    if in_a_row != LATE_IN_A_ROW + 1:
        return None
    return Event("plant", "WARN", f"{in_a_row} answers in a row were late or missing, up to sample {number}")


def rejected_event(rejected: Rejected, times: int) -> Event:
    """A refused frame: the first of a cause, and then one line at each doubling of its count."""
    return Event("recorder", "WARN", f"{times} refused on {rejected.topic}: {rejected.cause}, {rejected.detail}")


def is_reported(times: int) -> bool:
    """Whether the `times`-th event of its kind gets a line: 1, 2, 4, 8, ..."""
    return times & (times - 1) == 0
