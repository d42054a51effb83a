"""Frames and loads as they should not be: real ones, mutated, and what must be true of what a decoder makes of them."""

import json
import math
import random
import struct
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

import msgpack
from annotated_types import Len

from hydrohil.experiment.experiment import ExperimentError, from_bytes, to_bytes, to_plain
from hydrohil.services.controller.config import ControllerConfig, Reference
from hydrohil.services.plant.config import PlantConfig
from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.shared.contract.codec import WIRE_VERSION, Header, Received, Rejected, crc, decode, encode
from hydrohil.shared.contract.envelope import seal, section, unseal
from hydrohil.shared.contract.messages import Ask, PlantDescription
from hydrohil.shared.contract.topics import ANSWER, ASK, BY_SCHEMA, Topic, expression
from hydrohil.shared.transport.bus import Bus
from hydrohil.thesis.library import find
from tests.support.machines import description

CELL, OTHER_CELL = "cell", "left"
LONGEST_BURST = 32  # bits: every one shorter or as long is found by a CRC of 32 bits
INT64 = (-(2**63), 2**63 - 1)
FLOATS = (0.0, -0.0, 1.5, -1e300, 5e-324, math.nan, math.inf, -math.inf)
SECTIONS = {"plant": PlantConfig, "controller": ControllerConfig, "supervisor": SupervisorConfig, "reference": Reference}


class Fuzzed(NamedTuple):
    """Bytes for a decoder, and what is known of them."""

    topic: Topic
    key: str
    frame: bytes
    sealed: bool  # the CRC is right for these bytes: the decoder must decide by types alone


def value_of(hint: Any, rng: random.Random) -> Any:
    """A value of a field's type, often at the end of its range."""
    if get_origin(hint) is Annotated:
        kind, *bounds = get_args(hint)
        length = next(bound.min_length for bound in bounds if isinstance(bound, Len))
        return tuple(value_of(get_args(kind)[0], rng) for _ in range(length))
    if get_origin(hint) is tuple:
        return tuple(value_of(get_args(hint)[0], rng) for _ in range(rng.randrange(4)))
    if hint is PlantDescription:  # one that can be used: of any other no frame is accepted
        return description(period_ns=rng.randrange(1_000_000, 10_000_001), force_axis=rng.choice((0, 2)))
    if hasattr(hint, "_fields"):
        return hint(*(value_of(inner, rng) for inner in get_type_hints(hint, include_extras=True).values()))
    plain: dict[Any, Callable[[], Any]] = {
        int: lambda: rng.choice((*INT64, 0, 1, 127, 128, 2048, rng.randrange(*INT64))),
        float: lambda: rng.choice((*FLOATS, rng.gauss(0.0, 100.0))),
        str: lambda: rng.choice(("", "plant/sample", "rotate", "µ" * rng.randrange(20))),
        bytes: lambda: rng.randbytes(rng.choice((0, 1, 32, 60))),
    }
    return plain[hint]()


def real_frame(topic: Topic, rng: random.Random) -> tuple[str, bytes]:
    """A frame that a sender of this topic could send, and its key."""
    key = expression(CELL, topic.key)
    head: Header = value_of(Header, rng)._replace(version=WIRE_VERSION, schema=topic.schema, cell=CELL)
    head = head._replace(sender=topic.publisher or "operator", experiment=rng.randbytes(32))
    return key, encode(key, head, value_of(topic.message, rng))


JUNK: tuple[Any, ...] = (
    None,
    True,
    False,
    2**63,
    2**64 - 1,
    -(2**63),
    0,
    1.0,
    math.nan,
    math.inf,
    "text",
    b"bytes",
    [],
    [[]],
    [1, [2, [3]]],
    {},
    {"a": 1},
    {1: 2},
    msgpack.ExtType(5, b"x"),
    msgpack.Timestamp(1, 2),
    [2048, 2048, 2048],
    "x" * 5000,
)
LENGTHS = tuple(kind + b"\xff" * 4 for kind in (b"\xdd", b"\xc6", b"\xdf", b"\xdb", b"\xc9"))  # array, bin, map, str, ext: 4 GB
WORSE = (
    "",
    "{",
    "[" * 3000,
    '"',
    "null",
    "true",
    "-1",
    "1e999",
    "NaN",
    "-Infinity",
    "9" * 5000,
    "\ud800",
    "\x00",
    "0.0",
    '"a":{',
    ",",
)


def _flip(frame: bytes, bits: list[int]) -> bytes:
    changed = bytearray(frame)
    for bit in bits:
        changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)


def _few_bits(frame: bytes, rng: random.Random) -> bytes:
    return _flip(frame, rng.sample(range(8 * len(frame)), rng.choice((1, 1, 2, 2, 3, 4, 8, 40))))


def _burst(frame: bytes, rng: random.Random) -> bytes:
    start = rng.randrange(8 * len(frame))
    length = min(rng.randint(1, LONGEST_BURST), 8 * len(frame) - start)
    return _flip(frame, [start, *(start + i for i in range(1, length) if rng.random() < 0.5)])


def _length(frame: bytes, rng: random.Random) -> bytes:
    if rng.random() < 0.5:
        return frame[: rng.randrange(len(frame))]
    return frame + rng.randbytes(rng.choice((1, 4, 5000)))


def _place(fields: Any, rng: random.Random) -> Any:
    """The array with one element, at any depth, that is something else; or one too many or too few."""
    if not isinstance(fields, list) or not fields or rng.random() < 0.3:
        return rng.choice(JUNK)
    where, how = rng.randrange(len(fields)), rng.random()
    if how < 0.1:
        return [*fields[:where], *fields[where + 1 :]]
    if how < 0.2:
        return [*fields[:where], rng.choice(JUNK), *fields[where:]]
    return [*fields[:where], _place(fields[where], rng), *fields[where + 1 :]]


def _another_type(packed: bytes, rng: random.Random) -> bytes:
    changed: bytes = msgpack.packb(_place(msgpack.unpackb(packed), rng))
    return changed


def _nested(packed: bytes, rng: random.Random) -> bytes:
    opening = rng.choice((b"\x91", b"\x81\x01", b"\x9c", *LENGTHS))
    return packed[: rng.randrange(len(packed))] + opening * rng.choice((1, 2, 500, 1100)) + b"\xc0"


def mutated(topic: Topic, rng: random.Random) -> Fuzzed:
    """One frame of `topic` that is not as it was sent, by one of many ways."""
    key, frame = real_frame(topic, rng)
    way = rng.randrange(10)
    if way < 4:
        change = (_few_bits, _burst, _length, _few_bits)[way]
        return Fuzzed(topic, key, change(frame, rng), False)
    if way == 4:  # two frames spliced
        other = real_frame(rng.choice([*BY_SCHEMA.values()]), rng)[1]
        return Fuzzed(topic, key, frame[: rng.randrange(len(frame))] + other[rng.randrange(len(other)) :], False)
    if way == 5:  # replayed: another key, another cell
        elsewhere = expression(rng.choice((CELL, OTHER_CELL)), rng.choice([t.key for t in BY_SCHEMA.values() if t != topic]))
        return Fuzzed(topic, elsewhere, frame, False)
    packed = frame[:-4]
    if way == 6:
        packed = rng.randbytes(rng.choice((1, 3, 20, 200)))
    elif way == 7:
        packed = _nested(packed, rng)
    elif way == 8:
        packed = _few_bits(packed, rng)
    else:
        packed = _another_type(packed, rng)
    sealed = rng.random() < 0.9
    return Fuzzed(topic, key, packed + (crc(key, packed) if sealed else rng.randbytes(4)), sealed)


def bits_of(value: Any) -> Any:
    """A message with each float as its bits, so that NaN equals itself, and each value with its type."""
    if isinstance(value, tuple):
        return tuple(map(bits_of, value))
    return (type(value), struct.pack("<d", value) if isinstance(value, float) else value)


def complaint(fuzzed: Fuzzed) -> str:
    """What a decoder did that it must not; "" if nothing. Never raises unless the decoder does."""
    found = decode(fuzzed.key, fuzzed.topic, CELL, fuzzed.frame, 7)
    if isinstance(found, Rejected):
        return "" if found.arrival_ns == 7 and found.topic == fuzzed.topic.key else "a rejection without its place"
    if not isinstance(found, Received):
        return f"gave {type(found).__name__}"
    if not fuzzed.sealed and fuzzed.frame != _whole(fuzzed, found):
        return "a forgery was accepted"
    again = decode(fuzzed.key, fuzzed.topic, CELL, _whole(fuzzed, found), 7)
    if not isinstance(again, Received) or bits_of(again) != bits_of(found):
        return "what was accepted does not survive the wire"
    return "" if type(found.body) is fuzzed.topic.message else "a body of another class"


def _whole(fuzzed: Fuzzed, found: Received) -> bytes:
    return encode(fuzzed.key, found.header, found.body)


def loads() -> tuple[str, bytes]:
    """A real envelope's text and a real experiment's bytes."""
    experiment = find("fig-5-5")
    text = seal(to_plain(experiment), run=7, seed=1, clock="real", tare_ticks=444, duration_ticks=2000)
    return text, to_bytes(experiment)


def _worse_json(text: str, rng: random.Random) -> str:
    start = rng.randrange(len(text))
    piece = rng.choice(WORSE)
    return text[:start] + piece + text[start + rng.choice((0, 1, 1, 5, 200)) :]


def _other_value(text: str, rng: random.Random) -> str:
    """One value of the tree that is another."""
    tree = json.loads(text)
    place = tree
    while True:
        keys = list(place) if isinstance(place, dict) else list(range(len(place)))
        key = rng.choice(keys)
        if not (isinstance(place[key], dict | list) and place[key]) or rng.random() < 0.2:
            break
        place = place[key]
    place[key] = rng.choice((None, True, -1, 2**70, 1e308, math.nan, math.inf, "text", [], {}, [[]], {"a": 1}, -0.0))
    return json.dumps(tree)


def load_complaint(text: str, data: bytes, rng: random.Random) -> str:
    """What a worse envelope or experiment brought about that it must not; an error in words is what must come."""
    worse = rng.choice((_worse_json, _other_value))
    changed = worse(text, rng)
    try:
        envelope = unseal(changed)
        if changed != text and envelope.digest == unseal(text).digest:
            return "another text has the same hash"
        for name, kind in SECTIONS.items():
            section(envelope, name, kind)
    except ValueError as error:
        if "\n" in str(error):
            return "an envelope's error is more than one line"
    changed = worse(data.decode(), rng)
    try:
        from_bytes(changed.encode(errors="surrogatepass") if rng.random() < 0.9 else rng.randbytes(40))
    except ExperimentError:
        return ""
    return ""


class Query:
    """A request as the transport hands it over; keeps its replies."""

    def __init__(self, key: str, frame: bytes) -> None:
        self.key_expr, self.payload = key, SimpleNamespace(to_bytes=lambda: frame)
        self.replies: list[tuple[str, bytes]] = []

    def __enter__(self) -> "Query":
        return self

    def __exit__(self, *_: object) -> None:
        return

    def reply(self, key: str, frame: bytes) -> None:
        self.replies.append((key, frame))


ARGUMENTS = (b"", b"[]", b"{", b"5", b"[" * 3000, b"\xff\xfe", b'{"a": 1}', b'{"a": 1, "to": 1}')


def request_complaint(rng: random.Random) -> str:
    """A request, mutated or with arguments that are no JSON object: answered once with a reason, or handed on with a verb."""
    fuzzed = mutated(ASK, rng)
    if rng.random() < 0.5:
        head: Header = value_of(Header, rng)._replace(version=WIRE_VERSION, schema=ASK.schema, cell=CELL, sender="operator")
        key = expression(CELL, ASK.key)
        body = Ask(value_of(str, rng), rng.choice((*ARGUMENTS, rng.randbytes(30))))
        fuzzed = fuzzed._replace(key=key, frame=encode(key, head, body), sealed=True)
    query, bus = Query(fuzzed.key, fuzzed.frame), Bus("plant", CELL, 0, 1)
    bus._asked(query)
    handed = bus.requests()
    if len(handed) + len(query.replies) != 1:
        return "a request has not exactly one answer"
    if handed:
        return "" if type(handed[0].verb) is str and type(handed[0].arguments) is dict else "a request without verb or arguments"
    answer = decode(fuzzed.key, ANSWER, CELL, query.replies[0][1], 0)
    return (
        "" if isinstance(answer, Received) and not answer.body.accepted and answer.body.reason else "a refusal without a reason"
    )


def syndromes(topic: Topic, rng: random.Random) -> list[int]:
    """What flipping each bit of a frame does to its CRC. It is linear: what a pattern does is the XOR of what its bits do."""
    key, frame = real_frame(topic, rng)
    packed = frame[:-4]
    right = int.from_bytes(crc(key, packed), "little")
    of_bits = [int.from_bytes(crc(key, _flip(packed, [bit])), "little") ^ right for bit in range(8 * len(packed))]
    return [*of_bits, *(1 << bit for bit in range(32))]


def independent(vectors: list[int]) -> bool:
    """Whether no XOR of any of them is zero."""
    basis: list[int] = []
    for vector in vectors:
        left = vector
        for known in basis:
            left = min(left, left ^ known)
        if not left:
            return False
        basis.append(left)
    return True


def undetected(found: list[int]) -> Iterator[str]:
    """Patterns of one or two bits, and of bursts of up to 32, that the CRC would not see."""
    if 0 in found:
        yield f"bit {found.index(0)}"
    if len(set(found)) != len(found):
        yield "two bits"
    for start in range(len(found) - LONGEST_BURST + 1):
        if not independent(found[start : start + LONGEST_BURST]):
            yield f"a burst from bit {start}"
