"""An ear on the cell: samples, the gate's decisions, permits and commands, stamped on the monotonic clock as they arrive.

Every time that is measured here includes the message's way to the observer.
"""

import math
import time
from collections.abc import Sequence
from statistics import median
from typing import NamedTuple

from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.messages import NO_TRIAL, GateState
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.inbox import Inbox
from hydrohil.shared.units import NS_PER_S

RING = 8192
STEADY = 20  # samples that tell an offset
ZERO = (ZERO_CODE, ZERO_CODE, ZERO_CODE)
_MOVING = (GateState.OPEN, GateState.RECOVERING)


def safe(sample: Received) -> bool:
    """Zero current behind a gate that lets nothing through."""
    return sample.body.dac_counts == ZERO and sample.body.gate not in _MOVING


class Heard(NamedTuple):
    """Everything since the last trial began, in the order of arrival."""

    samples: list[Received]
    ground_truths: list[Received]
    gates: list[Received]
    permits: list[Received]
    commands: list[Received]


class Observer:
    """Rings on the loop's topics."""

    def __init__(self, bus: Bus) -> None:
        """Subscribe."""
        keys = ("plant/sample", "plant/ground_truth", "plant/gate", "supervisor/permit", "controller/command")
        self._inboxes: tuple[Inbox, ...] = tuple(bus.subscribe(key, RING) for key in keys)
        self.heard = Heard([], [], [], [], [])

    def forget(self) -> None:
        """A trial begins."""
        self.listen()
        self.heard = Heard([], [], [], [], [])

    def listen(self) -> Heard:
        """Take in what has arrived."""
        for messages, inbox in zip(self.heard, self._inboxes, strict=True):
            messages.extend(inbox.take())
        return self.heard

    def listen_for(self, seconds: float) -> Heard:
        """Go on listening for so long."""
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0.0:
            time.sleep(min(0.005, left))
            self.listen()
        return self.heard


def since(messages: Sequence[Received], instant_ns: int) -> list[Received]:
    """Those that arrived at or after an instant."""
    return [message for message in messages if message.arrival_ns >= instant_ns]


def zero_at(heard: Heard, blow_ns: int) -> int | None:
    """Arrival of the first word of zero current after the blow: the gate's own, or a sample's."""
    told = [m.arrival_ns for m in since(heard.gates, blow_ns) if m.body.state not in _MOVING]
    told += [m.arrival_ns for m in since(heard.samples, blow_ns) if safe(m)]
    return min(told, default=None)


def unsafe_after(heard: Heard, instant_ns: int) -> int:
    """Samples that are not safe although they arrived later than the first safe one after an instant."""
    later = since(heard.samples, instant_ns)
    first = next((number for number, sample in enumerate(later) if safe(sample)), len(later))
    return sum(not safe(sample) for sample in later[first:])


def stalled_s(heard: Heard, blow_ns: int) -> float:
    """By how much the plant's grid has shifted against the wall clock since the blow: it stood still, and so did its machine.

    A shift stays; a single message that comes late is none. So: the usual offset before, the smallest one after.
    """
    before = [m.arrival_ns - m.body.time_ns for m in heard.samples if m.arrival_ns < blow_ns][-STEADY:]
    later = since(heard.samples, blow_ns)
    first = next((number for number, sample in enumerate(later) if safe(sample)), len(later))
    after = [m.arrival_ns - m.body.time_ns for m in later[first : first + STEADY]]
    return max(0.0, min(after) - median(before)) / NS_PER_S if before and after else 0.0


def moved(heard: Heard, blow_ns: int) -> tuple[float, float]:
    """Largest way of the tip (mm) and change of the contact force (N) from the blow on; by what only an emulator knows."""
    before = [ground_truth for ground_truth in heard.ground_truths if ground_truth.arrival_ns < blow_ns]
    after = [ground_truth.body for ground_truth in since(heard.ground_truths, blow_ns)]
    if not before or not after:
        return math.nan, math.nan
    start = before[-1].body
    return (
        max(1000.0 * math.dist(ground_truth.tip_m, start.tip_m) for ground_truth in after),
        max(abs(ground_truth.contact_force_n - start.contact_force_n) for ground_truth in after),
    )


def hops(heard: Heard, instant_ns: int) -> tuple[tuple[str, float], ...]:
    """Milliseconds of each hop at an instant: how old the newest answers are, and what the last full round took."""
    sent = {m.body.number: m.arrival_ns for m in heard.samples if m.arrival_ns <= instant_ns}
    found = []
    for name, messages in (("command", heard.commands), ("permit", heard.permits)):
        known = [m for m in messages if m.arrival_ns <= instant_ns and m.header.echo_number in sent]
        if known:
            number = known[-1].header.echo_number
            found.append((f"sample to {name}", (known[-1].arrival_ns - sent[number]) / 1e6))
            found.append((f"age of the newest {name}'s sample", (instant_ns - sent[number]) / 1e6))
    accepted = [m.body.command_age_ns for m in heard.samples if m.arrival_ns <= instant_ns and m.body.tick != NO_TRIAL]
    if accepted:
        found.append(("sample to accepted", accepted[-1] / 1e6))
    return tuple(found)
