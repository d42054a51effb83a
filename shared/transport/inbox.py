"""One topic's bounded ring between the transport, which fills it, and the step, which drains it."""

import time
from collections import deque
from collections.abc import Callable
from typing import Any

from hydrohil.shared.contract.codec import Received, Rejected, decode
from hydrohil.shared.contract.messages import NO_COMMAND
from hydrohil.shared.contract.topics import Topic, expression
from hydrohil.shared.transport.acceptance import Acceptance
from hydrohil.shared.transport.impairment_conditions import Conditions
from hydrohil.shared.transport.impairment_queue import FOREVER_NS, ImpairedSample, ImpairmentQueue
from hydrohil.shared.transport.protection import Protection, ProtectionLimits

RING = 64  # frames kept for one step; a ring of one would let a foreign frame push out a valid one


class Inbox:
    """One topic's bounded ring, filled by the transport and drained by the step."""

    def __init__(self, topic: Topic, cell: str, depth: int, wake: Callable[[], None]) -> None:
        """An empty ring of `depth` frames."""
        self.topic, self.cell = topic, cell
        self.acceptance = Acceptance()
        self.protection = Protection(self.acceptance, ProtectionLimits())
        self._key = expression(cell, topic.key)
        self._ring: deque[tuple[int, bytes]] = deque(maxlen=depth)
        self._wake = wake
        self.impairment_queue: ImpairmentQueue | None = None  # transport faults, while any are loaded

    def put(self, sample: Any) -> None:
        """Transport's callback: stamp and append."""
        self._ring.append((time.monotonic_ns(), sample.payload.to_bytes()))
        self._wake()

    def impair(self, conditions: Conditions) -> None:
        """Let faults act on this topic, if any of `conditions` touches it; frames under way of the same load stay under way."""
        if self.impairment_queue is not None and self.impairment_queue.conditions is conditions:
            return
        self.impairment_queue = ImpairmentQueue(self.topic, conditions, self._decode) if conditions.touches(self.topic) else None

    def peek(self) -> Received | Rejected | None:
        """The newest frame, which stays in the ring; for a display of progress, never for control."""
        try:
            arrival_ns, frame = self._ring[-1]
        except IndexError:
            return None
        return self._decode(frame, arrival_ns)

    def drain(self, simulated_ns: int = FOREVER_NS) -> list[Received | Rejected]:
        """Everything that has come, in order, decoded but not yet judged; faults in lockstep go by simulated time."""
        frames = []
        while self._ring:
            arrival_ns, frame = self._ring.popleft()
            message = self._decode(frame, arrival_ns)
            if self.impairment_queue is None:
                frames.append(message)
            else:
                self.impairment_queue.admit(frame, message, simulated_ns)
        return frames if self.impairment_queue is None else self.impairment_queue.released(simulated_ns, time.monotonic_ns())

    def take(self, simulated_ns: int = FOREVER_NS) -> list[Received]:
        """Everything valid that has come, in order; the rest is counted in `acceptance`."""
        return [taken for message in self.drain(simulated_ns) if (taken := self.acceptance.take(message)) is not None]

    @property
    def number(self) -> int:
        """Sample that the newest frame taken is, answers or judges."""
        return NO_COMMAND if self.acceptance.bound is None else self.acceptance.bound.echo_number

    def impaired_samples(self) -> list[ImpairedSample]:
        """Samples that arrived in lockstep since the last call and did not come as they should."""
        if self.impairment_queue is None:
            return []
        found, self.impairment_queue.impaired_samples = self.impairment_queue.impaired_samples, []
        return found

    def arrived(self) -> int:
        """Newest sample whose answer has arrived, delayed or lost by a fault as it may be: no step waits for it."""
        return NO_COMMAND if self.impairment_queue is None else self.impairment_queue.newest

    def delay_ns(self, message: Received) -> int:
        """Simulated time by which faults delay `message` after its sample."""
        return 0 if self.impairment_queue is None else self.impairment_queue.delay_ns(message.header.echo_number)

    def _decode(self, frame: bytes, arrival_ns: int) -> Received | Rejected:
        return decode(self._key, self.topic, self.cell, frame, arrival_ns)
