"""Transport faults at a service's inboxes: frames that have arrived are delayed, lost, corrupted or doubled before the step.

In `real` a delay counts on the receiver's monotonic clock. In lockstep no service waits for a frame: the plant takes a late
answer at its sub-step of simulated time; the others answer a late sample at once, and the plant adds its delay to the answer's.
"""

from bisect import insort_right
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

from hydrohil.shared.contract.codec import Received, Rejected
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL
from hydrohil.shared.contract.topics import Topic
from hydrohil.shared.transport.impairment import SAMPLE, Outcome, flip
from hydrohil.shared.transport.impairment_conditions import Conditions
from hydrohil.shared.units import SUBSTEP_NS

Frame = Received | Rejected
FOREVER_NS = 1 << 62
_AHEAD = 64  # samples that an echo may be ahead of those that came: so many fit a ring; the plant knows all of its own


class Held(NamedTuple):
    """A frame under way."""

    release_ns: int
    frame: Frame


class Queue(NamedTuple):
    """What is under way to one inbox."""

    waiting: tuple[Held, ...] = ()  # in the order in which it comes
    overtaken: tuple[Frame, ...] = ()  # comes behind the next that is taken
    last_ns: int = 0  # release of the youngest that is taken


class ImpairedSample(NamedTuple):
    """A sample that arrived in lockstep and that a fault took, or after a silence that a fault caused."""

    number: int
    time_ns: int
    silence_ns: int  # simulated time since the newest sample that had come by then
    taken: bool  # it is answered, be it late; otherwise the plant must learn that it will not be


def send(queue: Queue, found: Outcome, frame: Frame, release_ns: int) -> Queue:
    """One frame more on its way, to come at `release_ns` but never before an older one."""
    if found.lost:
        return queue
    if found.overtaken:
        return queue._replace(overtaken=(*queue.overtaken, *(frame,) * found.copies))
    release_ns = max(release_ns, queue.last_ns)
    coming = (frame,) * found.copies + (queue.overtaken if found.taken else ())
    waiting = (*queue.waiting, *(Held(release_ns, one) for one in coming))
    return Queue(waiting, () if found.taken else queue.overtaken, release_ns)


def slip_in(queue: Queue, frame: Frame, release_ns: int) -> Queue:
    """A frame that answers no new sample: it may overtake others."""
    waiting = list(queue.waiting)
    insort_right(waiting, Held(release_ns, frame), key=lambda held: held.release_ns)
    return queue._replace(waiting=tuple(waiting))


def come(queue: Queue, now_ns: int) -> tuple[Queue, tuple[Held, ...]]:
    """What is still under way, and what has come by `now_ns`."""
    count = sum(held.release_ns <= now_ns for held in queue.waiting)
    return queue._replace(waiting=queue.waiting[count:]), queue.waiting[:count]


class ImpairmentQueue:
    """One inbox's frames between their arrival and the step."""

    def __init__(self, topic: Topic, conditions: Conditions, decode: Callable[[bytes, int], Frame]) -> None:
        """No frame is under way; `decode` reads a frame of which a fault has flipped a bit."""
        self._topic, self._decode = topic, decode
        self.conditions = conditions
        self.newest = NO_COMMAND  # sample that the newest frame arrived answers, whatever became of it
        self.impaired_samples: list[ImpairedSample] = []
        self._queue = Queue()
        self._coming_ns: deque[int] = deque()  # samples that are taken, in simulated time
        self._came_ns: int | None = None  # the newest of them that has come
        self._paces = conditions.lockstep and conditions.service == "plant"

    def admit(self, frame: bytes, message: Frame, now_ns: int) -> None:
        """A frame has arrived; `now_ns` is the plant's simulated time in lockstep."""
        if isinstance(message, Rejected):  # a foreign frame, or one that is corrupt already
            self._queue = slip_in(self._queue, message, 0)
            return
        header, conditions = message.header, self.conditions
        is_sample = self._topic.key == SAMPLE
        credible = self._credible(message, now_ns)
        if is_sample and credible:
            conditions.observe_sample(message.body.number, message.body.tick)
        answers = credible and header.echo_number > self.newest
        if answers:  # otherwise it is sent again, on change, or with an echo of nothing: what acts now acts on it
            self.newest = header.echo_number
            conditions.number = max(conditions.number, header.echo_number)
        tick = conditions.tick_of(header.echo_number) if answers else conditions.tick
        found = conditions.outcome(self._topic, header.echo_number, answers=answers)
        since_ns = self._since_ns(message, now_ns if not answers else header.echo_time_ns, tick)
        release_ns = since_ns + (found.delay if self._paces else found.own) * SUBSTEP_NS
        coming = self._decode(flip(frame, found.flipped), message.arrival_ns) if found.flipped >= 0.0 else message
        if answers:
            self._queue = send(self._queue, found, coming, release_ns)
        elif not found.lost:
            for _ in range(found.copies):
                self._queue = slip_in(self._queue, coming, release_ns)
        if is_sample and answers and conditions.lockstep:
            self._account(header.echo_number, header.echo_time_ns, tick, found)

    def _credible(self, message: Received, now_ns: int) -> bool:
        """Whether the echo may be that of a sample. One that cannot is for the receiver to judge, and sets no delay."""
        header, body = message.header, message.body
        if self._topic.key == SAMPLE:
            return (header.echo_number, header.echo_time_ns) == (body.number, body.time_ns)
        ahead = 0 if self.conditions.service == "plant" else _AHEAD
        return header.echo_number <= self.conditions.number + ahead and header.echo_time_ns <= now_ns

    def _since_ns(self, message: Received, simulated_ns: int, tick: int) -> int:
        """The instant from which a delay counts; 0 where no service waits for frames."""
        if not self.conditions.lockstep:
            return message.arrival_ns
        return simulated_ns if self._paces and tick != NO_TRIAL else 0

    def _account(self, number: int, time_ns: int, tick: int, found: Outcome) -> None:
        """Note when samples come in simulated time, and which of them a fault took or delayed."""
        if found.taken:
            self._coming_ns.append(time_ns + found.delay * SUBSTEP_NS)
        while self._coming_ns and self._coming_ns[0] <= time_ns:
            self._came_ns = self._coming_ns.popleft()
        silence_ns = 0 if self._came_ns is None else time_ns - self._came_ns
        if tick != NO_TRIAL and (not found.taken or silence_ns > 0):
            self.impaired_samples.append(ImpairedSample(number, time_ns, silence_ns, found.taken))

    def released(self, simulated_ns: int, wall_ns: int) -> list[Frame]:
        """What has come by now, in order; in `real` it is stamped with the instant at which it came."""
        self._queue, held = come(self._queue, simulated_ns if self.conditions.lockstep else wall_ns)
        if self.conditions.lockstep:
            return [one.frame for one in held]
        return [one.frame._replace(arrival_ns=max(one.release_ns, one.frame.arrival_ns)) for one in held]

    def next_ns(self) -> int:
        """When the next frame comes, on the wall clock; FOREVER_NS if none is under way, and in lockstep."""
        waiting = self._queue.waiting
        return waiting[0].release_ns if waiting and not self.conditions.lockstep else FOREVER_NS

    def delay_ns(self, number: int) -> int:
        """Simulated time from a sample to the coming of its answer."""
        return self.conditions.outcome(self._topic, number, answers=True).delay * SUBSTEP_NS
