"""Transport faults at a service's inboxes: frames that have arrived are delayed, lost, corrupted or doubled before the step.

In `real` a delay counts on the receiver's monotonic clock. In lockstep no service waits for a frame: the plant takes a late
answer at its sub-step of simulated time; the others answer a late sample at once, and the plant adds its delay to the answer's.
"""

from bisect import insort_right
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

from hydrohil.shared.contract.codec import Received, Rejected
from hydrohil.shared.contract.envelope import PERIOD_SUBSTEPS, Envelope, faults, period_substeps
from hydrohil.shared.contract.faults import Fault, ticks_of
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL, SampleDropped
from hydrohil.shared.contract.topics import Topic
from hydrohil.shared.transport.impairment import (
    SAMPLE,
    Active,
    Outcome,
    Route,
    both,
    flip,
    on_path,
    outcome,
    outcome_now,
    paths_of,
    route_of,
)
from hydrohil.shared.units import SUBSTEP_NS

Frame = Received | Rejected
Acting = dict[str, tuple[Active, ...]]  # by path
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


class Conditions:
    """The transport faults that one service knows: a trial's by its ticks, those injected by hand by the plant's samples."""

    def __init__(
        self, service: str, faults: tuple[Fault, ...], *, seed: int, period: int, ticks: tuple[int, int], lockstep: bool
    ) -> None:
        """`period` in sub-steps; `ticks` are the trial's first and the one after its last."""
        self.service, self.lockstep = service, lockstep
        self.by_hand: tuple[tuple[Fault, int], ...] = ()  # with the sample after which it was injected
        self.number, self.tick = NO_COMMAND, NO_TRIAL  # of the newest sample
        self._seed, self._period, self._ticks = seed, period, ticks
        self._zero: int | None = None  # number of the sample of tick 0
        self._routes: dict[tuple[str, bool], Route] = {}
        self._in_trial: Acting = {}
        self._injected: Acting = {}
        for path in {path for fault in faults for path in paths_of(fault)}:
            self._in_trial[path] = on_path(path, faults, period * SUBSTEP_NS)

    def inject(self, by_hand: tuple[tuple[Fault, int], ...]) -> None:
        """Let these act, and no others that were injected before."""
        self.by_hand, self._injected = by_hand, {}
        self._routes.clear()
        for fault, after in by_hand:
            for path in paths_of(fault):
                found = on_path(path, (fault,), self._period * SUBSTEP_NS)
                moved = (one._replace(begin=one.begin + after + 1, end=one.end + after + 1) for one in found)
                self._injected[path] = (*self._injected.get(path, ()), *moved)

    def begins(self, fault: Fault, after: int) -> int:
        """Number of the first sample with a fault that was injected after sample `after`."""
        return after + 1 + ticks_of(fault, self._period * SUBSTEP_NS)[0]

    def lasting(self) -> tuple[tuple[Fault, int], ...]:
        """What was injected by hand and is not over."""
        period_ns = self._period * SUBSTEP_NS
        ends = {entry: max(one.end for one in on_path(paths_of(entry[0])[0], (entry[0],), period_ns)) for entry in self.by_hand}
        return tuple(entry for entry in self.by_hand if self.number <= ends[entry] + entry[1])

    def touches(self, topic: Topic) -> bool:
        """Whether any fault acts on a topic's way to this service; `sample_dropped` always comes through."""
        if topic.message is SampleDropped:
            return False
        if topic.key == SAMPLE:  # it carries the tick, by which the faults of every topic act
            return any(path.endswith(f">{self.service}") for path in (*self._in_trial, *self._injected))
        return any(leg.faults for by_hand in (False, True) for leg in self._route(topic, by_hand=by_hand).legs)

    def outcome(self, topic: Topic, number: int, *, answers: bool) -> Outcome:
        """What becomes of a message: of one that answers sample `number`, or of one that is sent now."""
        tick = self.tick_of(number) if answers else self.tick
        outcome_of = outcome if answers else outcome_now
        found = outcome_of(self._route(topic, by_hand=False), tick) if tick != NO_TRIAL else Outcome()
        if not self.by_hand:
            return found
        return both(found, outcome_of(self._route(topic, by_hand=True), number if answers else self.number))

    def _route(self, topic: Topic, *, by_hand: bool) -> Route:
        if (topic.key, by_hand) not in self._routes:
            acting = self._injected if by_hand else self._in_trial
            route = route_of(topic, self.service, self._seed, self._period, acting)
            self._routes[topic.key, by_hand] = route._replace(legs=route.legs[-1:]) if by_hand else route
        return self._routes[topic.key, by_hand]

    def observe_sample(self, number: int, tick: int) -> None:
        """A sample was issued, or has arrived."""
        self.number, self.tick = number, tick
        self._zero = None if tick == NO_TRIAL else number - tick

    def tick_of(self, number: int) -> int:
        """Tick of a sample's number; NO_TRIAL where no fault of the trial acts."""
        tick = number - self._zero if self._zero is not None and number != NO_COMMAND else NO_TRIAL
        return tick if self._ticks[0] <= tick < self._ticks[1] else NO_TRIAL


def idle(service: str) -> Conditions:
    """Before anything is loaded."""
    return Conditions(service, (), seed=0, period=PERIOD_SUBSTEPS, ticks=(0, 0), lockstep=False)


def conditions_of(envelope: Envelope, before: Conditions) -> Conditions:
    """The transport faults of a load as a service meets them, with what was injected `before` by hand.

    Raises ValueError for a fault that the load's clock cannot play.
    """
    acting = faults(envelope, "transport")
    if before.lasting() and envelope.clock == "lockstep":
        raise ValueError("transport faults that were injected still act, and lockstep has none: `hydrohil inject --clear`")
    conditions = Conditions(
        before.service,
        acting,
        seed=envelope.seed,
        period=period_substeps(envelope),
        ticks=(-envelope.tare_ticks, envelope.duration_ticks),
        lockstep=envelope.clock == "lockstep",
    )
    conditions.observe_sample(before.number, before.tick)
    conditions.inject(before.lasting())
    return conditions


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
