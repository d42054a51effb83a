"""The transport faults that one service knows: those of a trial by its ticks, injected ones by the plant's samples."""

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
    on_path,
    outcome,
    outcome_now,
    paths_of,
    route_of,
)
from hydrohil.shared.units import SUBSTEP_NS

Acting = dict[str, tuple[Active, ...]]  # by path


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
