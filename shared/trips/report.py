"""The report of a trip from the signals around it: cause, numbers, moment, stop, ages, counters, and one sentence.

Pure: columns in, a document of plain values out. The recorder, `hydrohil run` and the local clock call the same function.
Every age is a difference on one machine's clock, and names that clock.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.messages import NO_TRIAL, GateCause, GateState, LinkStats, Mode, PlantDescription, TripCause
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.trips.ages import ages
from hydrohil.shared.trips.causes import CUTS, TRIPS, Cause, cut_happened, trip_happened
from hydrohil.shared.trips.tables import GATE, GROUND_TRUTH, PERMIT, SAMPLE, STATE, Table, Tables, row_of
from hydrohil.shared.units import NS_PER_S

FORMAT = "hydrohil trip report 1"
_ZERO = (ZERO_CODE,) * 3
_LATCHED = (Mode.TRIPPED, Mode.RECOVER)

Document = dict[str, Any]


class Trip(NamedTuple):
    """Who tripped, why, and at which sample."""

    by: str  # supervisor, gate
    cause: str
    measured: float
    limit: float
    sample: int
    happened: str
    row: Cause | None


class Origin(NamedTuple):
    """Moment, cell, receiver and run of a report."""

    utc: str
    cell: str
    receiver: str  # on whose clock arrivals are stamped
    run: int = 0
    experiment: str = ""  # its hash; on the local clock, which loads nothing, its name


def trip_report(
    signals: Tables,
    origin: Origin,
    description: PlantDescription | None = None,
    counters: Mapping[str, Any] | None = None,
    changed: Sequence[str] = (),
) -> Document | None:
    """The newest trip in `signals`, with the messages around it and what was `changed` by hand before; None if there is none."""
    trip = newest_trip(signals)
    if trip is None:
        return None
    document: Document = {
        "format": FORMAT,
        **origin._asdict(),
        "machine": description.machine.name if description is not None else "",
        "machine_hash": description.machine_hash.hex() if description is not None else "",
        "by": trip.by,
        "cause": trip.cause,
        "measured": _plain(trip.measured),
        "limit": _plain(trip.limit),
        "must_hold": trip.row.holds if trip.row else "",
        "to_do": trip.row.remedy if trip.row else "",
        "happened": trip.happened,
        "sample": trip.sample,
        **_when(signals, trip.sample),
        "stop": stop(signals, trip.sample, (description.machine if description is not None else UNIMATE).force.scale),
        "ages": ages(signals, trip.by, trip.sample, origin.receiver),
        "counters": dict(counters or {}),
        "changed": list(changed),
    }
    return document | {"sentence": sentence(document), "signals": _finite(signals)}


def newest_trip(signals: Tables) -> Trip | None:
    """The supervisor's last trip, or the gate's cut if that caused it or stands alone."""
    permits, cut = signals.get(PERMIT, {}), _cut(signals)
    modes = permits.get("mode", [])
    if not modes or modes[-1] not in _LATCHED:
        return cut
    first = len(modes) - 1
    number = permits["trip_number"][-1]
    while first > 0 and modes[first - 1] in _LATCHED and permits["trip_number"][first - 1] == number:
        first -= 1
    cause = TripCause(permits["cause"][first])
    if cause == TripCause.GATE_CUT and cut is not None:
        return cut
    measured, limit = permits["measured"][first], permits["limit"][first]
    happened = trip_happened(cause, measured, limit)
    return Trip(
        by="supervisor",
        cause=cause.name,
        measured=measured,
        limit=limit,
        sample=number,
        happened=happened,
        row=TRIPS.get(cause),
    )


def _cut(signals: Tables) -> Trip | None:
    """The newest cut by which the gate revoked an arming of its own accord."""
    events = signals.get(GATE, {})
    for i in reversed(range(len(events.get("state", [])))):
        cause = GateCause(events["cause"][i])
        if events["state"][i] == GateState.REVOKED and cause != GateCause.REVOKED_ARMING:
            measured, limit = events["measured"][i], events["limit"][i]
            happened = cut_happened(cause, measured, limit)
            return Trip(
                by="gate",
                cause=cause.name,
                measured=measured,
                limit=limit,
                sample=events["number"][i],
                happened=happened,
                row=CUTS.get(cause),
            )
    return None


def _when(signals: Tables, number: int) -> Document:
    samples = signals.get(SAMPLE, {})
    i = row_of(samples, number)
    if i is None or samples["tick"][i] == NO_TRIAL:
        return {"tick": None, "trial_time_s": None}
    return {"tick": samples["tick"][i], "trial_time_s": samples["trial_time_ns"][i] / NS_PER_S}


def stop(signals: Tables, number: int, n_per_count: float) -> Document:
    """When the gate was at zero current; motion of the tip and peak force from the trip's sample to the end of the signals."""
    samples = signals.get(SAMPLE, {})
    later = [i for i, n in enumerate(samples.get("number", [])) if n >= number]
    zero = next((i for i in later if tuple(samples[f"dac_counts[{k}]"][i] for k in range(3)) == _ZERO), None)
    forces = [samples["force_counts"][i] * n_per_count for i in later if samples["force_counts"][i] is not None]
    table, field = (signals[GROUND_TRUTH], "tip_m") if GROUND_TRUTH in signals else (signals.get(STATE, {}), "x_m")
    return {
        "zero_sample": None if zero is None else samples["number"][zero],
        "samples_later": None if zero is None else samples["number"][zero] - number,
        "tip_moved_m": _moved(table, field, number),
        "tip_from": "the emulator's ground truth" if GROUND_TRUTH in signals else "the encoders",
        "force_n": forces[0] if forces else None,
        "force_peak_n": max(forces, key=abs) if len(forces) > 1 else None,
        "samples_after": len(later) - 1 if later else 0,
    }


def _moved(table: Table, field: str, number: int) -> float | None:
    """Largest distance from the point's position at the trip's sample; None if that or the later positions are not known."""
    start = row_of(table, number)
    if start is None or start + 1 >= len(table["number"]) or f"{field}[0]" not in table:
        return None
    points = list(zip(*(table[f"{field}[{axis}]"][start:] for axis in range(3)), strict=True))
    return max(math.dist(points[0], point) for point in points)


def counters_of(link_stats_by_receiver: Mapping[str, LinkStats]) -> Document:
    """Counts of each receiver by topic and cause; zeros are left out, but not those of accepted messages."""
    return {
        receiver: {
            inbox.topic: {
                name: count for name, count in inbox._asdict().items() if name != "topic" and (count or name == "accepted")
            }
            for inbox in link_stats.inboxes
        }
        for receiver, link_stats in sorted(link_stats_by_receiver.items())
    }


def sentence(document: Document) -> str:
    """The trip in plain words."""
    when = f"sample {document['sample']}"
    if document["tick"] is not None:
        when += f" (tick {document['tick']}, {document['trial_time_s']:.3f} s)"
    happened = document["happened"]
    subject = "The gate cut by itself: " if document["by"] == "gate" else ""
    begin = subject + happened if subject else happened[0].upper() + happened[1:]
    return f"{begin} at {when}; {_zero_words(document['stop'])}{_motion_words(document['stop'])}."


def _zero_words(stopped: Document) -> str:
    later = stopped["samples_later"]
    if later is None:
        return "no later sample has shown the gate at zero current"
    if later == 0:
        return "the gate was at zero current already"
    return f"the gate was at zero current {later} sample{'' if later == 1 else 's'} later"


def _motion_words(stopped: Document) -> str:
    found = []
    if stopped["tip_moved_m"] is not None:
        found.append(f"the tip moved {stopped['tip_moved_m'] * 1e3:.1f} mm")
    if stopped["force_peak_n"] is not None and abs(stopped["force_peak_n"]) > abs(stopped["force_n"]):
        found.append(f"the force rose to {stopped['force_peak_n']:.1f} N")
    return f"; meanwhile {' and '.join(found)}" if found else ""


def _plain(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _finite(signals: Tables) -> dict[str, Table]:
    """The signals with null for what is no number: a file that every reader opens."""
    return {topic: {name: _finite_column(column) for name, column in table.items()} for topic, table in signals.items()}


def _finite_column(column: Sequence[Any]) -> list[Any]:
    return [None if isinstance(value, float) and not math.isfinite(value) else value for value in column]
