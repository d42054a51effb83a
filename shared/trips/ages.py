"""How old each message was at a trip: every age is a difference of two stamps of one clock, which it names.

The plant reports the ages of permit and command at its gate, the controller its own computing time. Ages of arrivals are on the
clock of the receiver that collected the messages; one below zero says that an answer came there before its sample. In lockstep
the plant's clock is simulated time. Two machines' clocks are never subtracted.
"""

from typing import Any

from hydrohil.shared.trips.tables import COMMAND, GATE, PERMIT, SAMPLE, STATE, Tables, row_of
from hydrohil.shared.units import NS_PER_S

PLANT, CONTROLLER = "the plant's", "the controller's"
_ANSWERS = ((COMMAND, "its command heard"), (STATE, "the controller's state heard"), (PERMIT, "its permit heard"))

Hop = dict[str, Any]  # hop, age_s, clock


def ages(signals: Tables, by: str, number: int, receiver: str) -> list[Hop]:
    """Ages of every hop at the sample of the trip; `by` is "supervisor" or "gate", `receiver` names the clock of the arrivals."""
    hops = _at_the_gate(signals, number) + _at_the_controller(signals, number)
    return hops + _after_the_sample(signals, number, receiver) + _last_heard(signals, by, number, receiver)


def _at_the_gate(signals: Tables, number: int) -> list[Hop]:
    """The command in force at the sample, and permit and command at the gate's next decision that was not "accepted"."""
    samples, hops = signals.get(SAMPLE, {}), []
    if (i := row_of(samples, number)) is not None and "command_age_ns" in samples:
        answered, age_ns = samples["command_number"][i], samples["command_age_ns"][i]
        hops.append(_hop(f"sample {answered} -> its command accepted by the gate", age_ns, PLANT))
    events = signals.get(GATE, {})
    decided = next((i for i, n in enumerate(events.get("number", [])) if n >= number), None)
    if decided is not None:
        latest = events["number"][decided]
        for what in ("permit", "command"):
            age_ns = events[f"{what}_age_ns"][decided]
            if age_ns >= 0:
                hops.append(_hop(f"the sample that its {what} names -> the gate decides on sample {latest}", age_ns, PLANT))
    return hops


def _at_the_controller(signals: Tables, number: int) -> list[Hop]:
    states = signals.get(STATE, {})
    i = row_of(states, number)
    if i is None or "compute_ns" not in states:
        return []
    return [_hop(f"sample {number} -> the controller has computed", states["compute_ns"][i], CONTROLLER)]


def _after_the_sample(signals: Tables, number: int, receiver: str) -> list[Hop]:
    """From the arrival of a sample to that of its command, state and permit: for the sample of the trip, and the one before."""
    hops = []
    samples = signals.get(SAMPLE, {})
    for sample in (number - 1, number):
        i = row_of(samples, sample)
        if i is None or "arrival_ns" not in samples:
            continue
        for topic, what in _ANSWERS:
            table = signals.get(topic, {})
            j = row_of(table, sample, "echo_number")
            if j is not None:
                age = table["arrival_ns"][j] - samples["arrival_ns"][i]
                hops.append(_hop(f"sample {sample} heard -> {what}", age, receiver))
    return hops


def _last_heard(signals: Tables, by: str, number: int, receiver: str) -> list[Hop]:
    """Age of the newest message of each sender when the trip was reported to the receiver, and which sample it named."""
    table = signals.get(GATE if by == "gate" else PERMIT, {})
    column = "number" if by == "gate" else "trip_number"
    i = row_of(table, number, column)
    if i is None or "arrival_ns" not in table:
        return []
    heard_ns, hops = table["arrival_ns"][i], []
    for topic, what in ((SAMPLE, "sample"), (COMMAND, "command"), (PERMIT, "permit")):
        arrivals = signals.get(topic, {}).get("arrival_ns", [])
        newest = max((j for j, arrival in enumerate(arrivals) if arrival < heard_ns), key=arrivals.__getitem__, default=None)
        if newest is not None:
            named = signals[topic]["echo_number"][newest]
            hops.append(_hop(f"last {what} heard (sample {named}) -> the trip heard", heard_ns - arrivals[newest], receiver))
    return hops


def _hop(hop: str, age_ns: int, clock: str) -> Hop:
    return {"hop": hop, "age_s": age_ns / NS_PER_S, "clock": clock}
