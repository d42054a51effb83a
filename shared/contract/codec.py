"""Frames on the wire: MessagePack array and CRC-32, checked type by type. Rejections are values, never exceptions.

frame = msgpack([wire version, schema id, cell, run id, experiment hash, sender, epoch, arming, seq,
                 echo number, echo time in ns, body]) + CRC-32 (little endian) over key expression, NUL and these bytes.

Each field answers a failure mode that functional safety lists for black channels: seq repetition, deletion and
resequencing; epoch, run and arming insertion; echo delay; cell and sender masquerade; CRC corruption.
"""

import zlib
from collections.abc import Callable
from functools import cache
from itertools import chain
from operator import itemgetter
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

import msgpack
from annotated_types import Len

from hydrohil.shared.contract.topics import Topic

WIRE_VERSION = 1
MAX_FRAME_BYTES = 4096
MAX_REQUEST_BYTES = 1 << 20
MAX_NAME = 64  # characters of a cell's or sender's name
_CRC_BYTES = 4
_INT64 = 1 << 63


class Header(NamedTuple):
    """Who says it, in which run, answering what."""

    version: int
    schema: int
    cell: str
    run: int
    experiment: bytes  # SHA-256 over the experiment as sent; empty before a load
    sender: str
    epoch: int  # drawn when the sender started or was reset
    arming_id: int  # 0 = none
    seq: int
    echo_number: int  # sample that this answers or judges
    echo_time_ns: int


class Received(NamedTuple):
    """A valid frame."""

    arrival_ns: int  # receiver's monotonic clock
    topic: str
    header: Header
    body: Any


class Rejected(NamedTuple):
    """A frame that is not ours, and why."""

    arrival_ns: int
    topic: str
    cause: str  # oversized, crc, malformed, version, schema, cell, sender
    detail: str
    header: Header | None = None  # where one could be read; under a wrong CRC it is no more than a hint at the link


def crc(key: str, packed: bytes) -> bytes:
    """CRC-32 over key expression and bytes, so that a frame replayed on another key is corrupt."""
    return zlib.crc32(packed, zlib.crc32(key.encode() + b"\0")).to_bytes(_CRC_BYTES, "little")


def encode(key: str, header: Header, body: tuple[Any, ...]) -> bytes:
    """The frame for `body`; numpy integers and bools raise TypeError, they have no place on the wire."""
    packed: bytes = msgpack.packb((*header, body))
    return packed + crc(key, packed)


def decode(key: str, topic: Topic, cell: str, frame: bytes, arrival_ns: int) -> Received | Rejected:
    """The message in `frame`, or why it is not ours."""

    header: Header | None = None

    def reject(cause: str, detail: str) -> Rejected:
        return Rejected(arrival_ns, topic.key, cause, detail, header)

    limit = MAX_REQUEST_BYTES if topic.key.startswith("operator/") else MAX_FRAME_BYTES
    if not _CRC_BYTES < len(frame) <= limit:
        cause = "malformed" if len(frame) <= _CRC_BYTES else "oversized"
        return reject(cause, f"{len(frame)} bytes, expected {_CRC_BYTES + 1} to {limit}")
    packed = frame[:-_CRC_BYTES]
    fields = _unpacked(packed)
    if type(fields) is tuple:
        header = _shape(Header)(fields[:-1])
    if crc(key, packed) != frame[-_CRC_BYTES:]:
        return reject("crc", "checksum differs")
    if isinstance(fields, Exception):
        return reject("malformed", type(fields).__name__)
    if type(fields) is not tuple or not fields or fields[0] != WIRE_VERSION or type(fields[0]) is not int:
        return reject("version", f"wire version {_named(fields)}, this is {WIRE_VERSION}")
    if header is None:
        return reject("malformed", "header")
    if header.schema != topic.schema:
        return reject("schema", f"schema {header.schema}, {topic.key} is {topic.schema}")
    if header.cell != cell:
        return reject("cell", f"cell {header.cell[:MAX_NAME]}, this is {cell}")
    if topic.publisher and header.sender != topic.publisher:
        return reject("sender", f"sender {header.sender[:MAX_NAME]}, expected {topic.publisher}")
    body = _shape(topic.message)(fields[-1])
    if body is None:
        return reject("malformed", f"body of {topic.key}")
    return Received(arrival_ns, topic.key, header, body)


def _unpacked(packed: bytes) -> Any:
    """What the bytes hold, whoever wrote them; the exception, as a value, if they are no MessagePack."""
    try:
        return msgpack.unpackb(packed, use_list=False, max_ext_len=0, max_map_len=0)
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        return error


def _named(fields: Any) -> str:
    """What stands in the version's place; a tuple by its type alone, for its own text could be nested too deep to be written."""
    found = fields[0] if type(fields) is tuple and fields else fields
    return str(found)[:MAX_NAME] if isinstance(found, int | float | str | bytes) else type(found).__name__


def _fit(values: tuple[int, ...]) -> bool:
    """Whether every int fits 64 bits with a sign; msgpack carries larger ones, but no smaller."""
    return not values or max(values) < _INT64


@cache
def _shape(message: Any) -> Callable[[Any], Any]:
    """Checker and builder for one message class: the message, or None if anything differs.

    Type-strict: a bool is no int, an int is no float.
    """
    hints = list(get_type_hints(message, include_extras=True).values())
    kinds = tuple(hint if isinstance(hint, type) and not hasattr(hint, "_fields") else tuple for hint in hints)
    arrays = [(place, *_array(hint)) for place, hint in enumerate(hints) if kinds[place] is tuple and _array(hint)]
    inner = [(place, _inner(hint)) for place, hint in enumerate(hints) if kinds[place] is tuple and not _array(hint)]
    lengths, leaves = tuple(length for _, _, length in arrays), tuple(kind for _, kind, length in arrays for _ in range(length))
    rows, whole = _picked([place for place, _, _ in arrays]), _picked([i for i, kind in enumerate(kinds + leaves) if kind is int])

    def build(values: Any) -> Any:
        if type(values) is not tuple or tuple(map(type, values)) != kinds:
            return None
        flat = values
        if arrays:  # all of them at once: a check of each would cost ten times as much
            found = rows(values)
            flat += tuple(chain.from_iterable(found))
            if tuple(map(len, found)) != lengths or tuple(map(type, flat[len(kinds) :])) != leaves:
                return None
        if not _fit(whole(flat)):
            return None
        return _built(message, values, inner) if inner else tuple.__new__(message, values)

    return build


def _picked(places: list[int]) -> Callable[[Any], tuple[Any, ...]]:
    """The elements at `places`, as a tuple whatever their number."""
    if len(places) == 1:
        (place,) = places
        return itemgetter(slice(place, place + 1))
    return itemgetter(*places) if places else itemgetter(slice(0))


def _built(message: Any, values: tuple[Any, ...], inner: list[tuple[int, Callable[[Any], Any]]]) -> Any:
    """A message with others inside; None if one of those is not as it should be."""
    made = list(values)
    for place, check in inner:
        made[place] = check(values[place])
        if made[place] is None:
            return None
    return message._make(made)


def _array(hint: Any) -> tuple[type, int] | tuple[()]:
    """Kind and number of a field's scalars, if that number is fixed; () of any other field."""
    if get_origin(hint) is not Annotated:
        return ()
    kind, *bounds = get_args(hint)
    item = get_args(kind)[0]
    length = next((bound.min_length for bound in bounds if isinstance(bound, Len)), None)
    return () if length is None else (item, length)


def _inner(hint: Any) -> Callable[[Any], Any]:
    """Checker for a field that is a message, or any number of messages of one kind: its value, or None."""
    return _shape(hint) if hasattr(hint, "_fields") else _messages(_shape(get_args(hint)[0]))


def _messages(build: Callable[[Any], Any]) -> Callable[[Any], Any]:
    def check(value: Any) -> Any:
        made = tuple(map(build, value))
        return None if None in made else made

    return check
