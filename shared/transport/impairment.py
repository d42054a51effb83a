"""What transport faults do to each message: a function of (seed, path, topic, tick), the same on every clock.

A path is a pair sender>receiver. Time is nominal here: tick k leaves the plant at sub-step k T, and an answer leaves when the
sample that it answers has come. Which message overtakes which is decided on that grid, not by the wall clock.
"""

import math
from functools import lru_cache
from hashlib import blake2b
from typing import NamedTuple

from hydrohil.shared.contract.faults import CUTS, PATHS, Fault, ticks_of
from hydrohil.shared.contract.topics import Topic
from hydrohil.shared.units import SUBSTEP_NS

SAMPLE = "plant/sample"
SUBSTEPS_PER_MS = 1_000_000 // SUBSTEP_NS
_DRAWN_BITS = 64
_REMEMBERED = 1 << 14  # outcomes of 30 s on one path and the one before it
_NOWHERE = -1.0


class Active(NamedTuple):
    """One fault on one path: ticks from `begin` to before `end` have it."""

    kind: str
    begin: int
    end: int
    amount: float  # probability; sub-steps for a delay or jitter


class Leg(NamedTuple):
    """One topic's way from a sender to a receiver."""

    path: str
    topic: str
    faults: tuple[Active, ...]


class Route(NamedTuple):
    """The whole way of a message since its sample was taken: the sample's own first where it is an answer."""

    seed: int
    period: int  # sub-steps
    legs: tuple[Leg, ...]


class Effect(NamedTuple):
    """What one leg does to a message."""

    lost: bool = False
    delay: int = 0  # sub-steps
    swapped: bool = False  # its successor comes before it
    copies: int = 1
    flipped: float = _NOWHERE  # where the bit that flips stands, as a share of the frame


class Outcome(NamedTuple):
    """What becomes of a message on its route."""

    lost: bool = False
    overtaken: bool = False  # it comes after a younger one, and is old
    delay: int = 0  # sub-steps since the sample was taken
    own: int = 0  # of these, on the last leg
    copies: int = 1
    flipped: float = _NOWHERE

    @property
    def taken(self) -> bool:
        """Whether the receiver takes it."""
        return not self.lost and not self.overtaken and self.flipped == _NOWHERE


def paths_of(fault: Fault) -> tuple[str, ...]:
    """The paths that `fault` acts on: one, or both ways of a cut."""
    if fault.target not in CUTS:
        return (fault.target,)
    one, other = fault.target.split("-")
    return tuple(path for path in (f"{one}>{other}", f"{other}>{one}") if path in PATHS)


def on_path(path: str, faults: tuple[Fault, ...], period_ns: int) -> tuple[Active, ...]:
    """What acts on one path."""
    found = []
    for fault in faults:
        if path in paths_of(fault):
            amount = fault.value * SUBSTEPS_PER_MS if fault.kind in ("delay", "jitter") else fault.value
            begin, end = ticks_of(fault, period_ns)
            end = begin + int(fault.value) if fault.kind == "burst" else end
            found.append(Active(fault.kind, begin, end, amount))
    return tuple(found)


def route_of(topic: Topic, receiver: str, seed: int, period: int, acting: dict[str, tuple[Active, ...]]) -> Route:
    """The way of a topic to `receiver`; all services but the plant send when a sample has come to them."""
    own = f"{topic.publisher}>{receiver}"
    legs: tuple[Leg, ...] = (Leg(own, topic.key, acting.get(own, ())),)
    if topic.publisher != "plant":
        to_sender = f"plant>{topic.publisher}"
        legs = (Leg(to_sender, SAMPLE, acting.get(to_sender, ())), *legs)
    return Route(seed, period, legs)


def draw(seed: int, leg: Leg, fault: Active, tick: int) -> float:
    """A number in [0, 1) that belongs to this message and this fault alone."""
    name = f"{seed} {leg.path} {leg.topic} {fault.kind} {fault.begin} {tick}"
    drawn = int.from_bytes(blake2b(name.encode(), digest_size=_DRAWN_BITS // 8).digest(), "little")
    return math.ldexp(drawn >> 11, 11 - _DRAWN_BITS)  # 53 bits, so that it stays below 1


@lru_cache(_REMEMBERED)  # a late message is compared with all that may overtake it
def effect(route: Route, tick: int) -> Effect:
    """What the last leg does to the message of `tick`."""
    leg, found = route.legs[-1], Effect()
    for fault in leg.faults:
        if fault.begin <= tick < fault.end:
            found = _with_fault(found, fault, draw(route.seed, leg, fault, tick), route.period)
    return found


def _with_fault(before: Effect, fault: Active, drawn: float, period: int) -> Effect:
    hit = drawn < fault.amount
    match fault.kind:
        case "partition" | "burst":
            return before._replace(lost=True)
        case "loss":
            return before._replace(lost=before.lost or hit)
        case "duplicate":
            return before._replace(copies=before.copies + hit)
        case "delay":
            return before._replace(delay=before.delay + round(fault.amount))
        case "jitter":
            return before._replace(delay=before.delay + int(drawn * (round(fault.amount) + 1)))
        case "reorder" if hit and not before.swapped:
            return before._replace(swapped=True, delay=before.delay + period)
        case "corrupt" if hit:
            return before._replace(flipped=drawn / fault.amount)
    return before


def both(one: Outcome, other: Outcome) -> Outcome:
    """What becomes of a message that meets two sets of faults."""
    return Outcome(
        lost=one.lost or other.lost,
        overtaken=one.overtaken or other.overtaken,
        delay=one.delay + other.delay,
        own=one.own + other.own,
        copies=one.copies + other.copies - 1,
        flipped=max(one.flipped, other.flipped),
    )


def outcome_now(route: Route, tick: int) -> Outcome:
    """What becomes of a message that answers no new sample: the faults that act at `tick` on the last leg act on it."""
    own = effect(route, tick)
    return Outcome(lost=own.lost, delay=own.delay, own=own.delay, copies=own.copies, flipped=own.flipped)


@lru_cache(_REMEMBERED)
def outcome(route: Route, tick: int) -> Outcome:
    """What becomes of the message of `tick`."""
    before = 0
    if len(route.legs) > 1:
        upstream = outcome(route._replace(legs=route.legs[:-1]), tick)
        before = upstream.delay if upstream.taken else 0
    own = effect(route, tick)
    delay = before + own.delay
    return Outcome(
        lost=own.lost,
        overtaken=not own.lost and _overtaken(route, tick, delay, own),
        delay=delay,
        own=own.delay,
        copies=own.copies,
        flipped=own.flipped,
    )


def _overtaken(route: Route, tick: int, delay: int, own: Effect) -> bool:
    """Whether a younger message comes before this one; on a tie the older is first, unless it changed places."""
    arrival = (tick * route.period + delay, own.swapped)
    return any(_arrival(route, younger) < arrival for younger in range(tick + 1, tick + delay // route.period + 1))


def _arrival(route: Route, tick: int) -> tuple[float, bool]:
    """When a message comes, in sub-steps, and whether it lets its successor pass; infinity if it never comes."""
    before = 0
    if len(route.legs) > 1:
        upstream = outcome(route._replace(legs=route.legs[:-1]), tick)
        if not upstream.taken:
            return math.inf, False
        before = upstream.delay
    own = effect(route, tick)
    if own.lost or own.flipped != _NOWHERE:
        return math.inf, False
    return tick * route.period + before + own.delay, own.swapped


def flip(frame: bytes, share: float) -> bytes:
    """`frame` with the one bit turned that stands at this share of its length."""
    bit = int(share * 8 * len(frame))
    turned = bytearray(frame)
    turned[bit // 8] ^= 1 << bit % 8
    return bytes(turned)
