"""An observer of the cell: samples, the gate's decisions, permits and commands, stamped on the monotonic clock as they arrive.

Every time that is measured here includes the transport of the message to the observer.
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
STEADY = 20  # samples from which an offset is taken
ZERO = (ZERO_CODE, ZERO_CODE, ZERO_CODE)
_MOVING = (GateState.OPEN, GateState.RECOVERING)


def safe(sample: Received) -> bool:
    """Zero current behind a gate that lets nothing through."""
    return sample.body.dac_counts == ZERO and sample.body.gate not in _MOVING


class Observation(NamedTuple):
    """Every message since the trial began, in the order of arrival."""

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
        self.observed = Observation([], [], [], [], [])

    def clear(self) -> None:
        """Drop every message: a trial begins."""
        self.listen()
        self.observed = Observation([], [], [], [], [])

    def listen(self) -> Observation:
        """Take in what has arrived."""
        for messages, inbox in zip(self.observed, self._inboxes, strict=True):
            messages.extend(inbox.take())
        return self.observed

    def listen_for(self, seconds: float) -> Observation:
        """Go on listening for so long."""
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0.0:
            time.sleep(min(0.005, left))
            self.listen()
        return self.observed


def since(messages: Sequence[Received], instant_ns: int) -> list[Received]:
    """Those that arrived at or after an instant."""
    return [message for message in messages if message.arrival_ns >= instant_ns]


def zero_at(observed: Observation, fault_ns: int) -> int | None:
    """Arrival of the first message that shows zero current after the fault: the gate's own, or a sample."""
    arrivals = [m.arrival_ns for m in since(observed.gates, fault_ns) if m.body.state not in _MOVING]
    arrivals += [m.arrival_ns for m in since(observed.samples, fault_ns) if safe(m)]
    return min(arrivals, default=None)


def unsafe_after(observed: Observation, instant_ns: int) -> int:
    """Samples that are not safe although they arrived later than the first safe one after an instant."""
    later = since(observed.samples, instant_ns)
    first = next((number for number, sample in enumerate(later) if safe(sample)), len(later))
    return sum(not safe(sample) for sample in later[first:])


def stalled_s(observed: Observation, fault_ns: int) -> float:
    """By how much the plant's grid has shifted against the wall clock since the fault: it stood still, and so did its machine.

    A shift stays, and a single late message is no shift: the smallest offset after the fault is set against the usual one before.
    """
    before = [m.arrival_ns - m.body.time_ns for m in observed.samples if m.arrival_ns < fault_ns][-STEADY:]
    later = since(observed.samples, fault_ns)
    first = next((number for number, sample in enumerate(later) if safe(sample)), len(later))
    after = [m.arrival_ns - m.body.time_ns for m in later[first : first + STEADY]]
    return max(0.0, min(after) - median(before)) / NS_PER_S if before and after else 0.0


def moved(observed: Observation, fault_ns: int) -> tuple[float, float]:
    """Largest distance of the tip (mm) and change of the contact force (N) since the fault, from the ground truth."""
    before = [ground_truth for ground_truth in observed.ground_truths if ground_truth.arrival_ns < fault_ns]
    after = [ground_truth.body for ground_truth in since(observed.ground_truths, fault_ns)]
    if not before or not after:
        return math.nan, math.nan
    start = before[-1].body
    return (
        max(1000.0 * math.dist(ground_truth.tip_m, start.tip_m) for ground_truth in after),
        max(abs(ground_truth.contact_force_n - start.contact_force_n) for ground_truth in after),
    )


def hops(observed: Observation, instant_ns: int) -> tuple[tuple[str, float], ...]:
    """Milliseconds of each hop at an instant: how old the newest answers are, and what the last full round took."""
    sent = {m.body.number: m.arrival_ns for m in observed.samples if m.arrival_ns <= instant_ns}
    found = []
    for name, messages in (("command", observed.commands), ("permit", observed.permits)):
        known = [m for m in messages if m.arrival_ns <= instant_ns and m.header.echo_number in sent]
        if known:
            number = known[-1].header.echo_number
            found.append((f"sample to {name}", (known[-1].arrival_ns - sent[number]) / 1e6))
            found.append((f"age of the newest {name}'s sample", (instant_ns - sent[number]) / 1e6))
    accepted = [m.body.command_age_ns for m in observed.samples if m.arrival_ns <= instant_ns and m.body.tick != NO_TRIAL]
    if accepted:
        found.append(("sample to accepted", accepted[-1] / 1e6))
    return tuple(found)
