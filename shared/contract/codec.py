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

from hydrohil.shared.contract.topics import Topic

WIRE_VERSION = 1
MAX_FRAME_BYTES = 4096
MAX_REQUEST_BYTES = 1 << 20
MAX_NAME = 64  # characters of a cell's or sender's name
_CRC_BYTES = 4
_INT64 = 1 << 63


class Header(NamedTuple):
    """Sender, run, and the sample that the message answers or judges."""

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
        header = _header(fields[:-1])
    if crc(key, packed) != frame[-_CRC_BYTES:]:
        return reject("crc", "checksum differs")
    if isinstance(fields, Exception):
        return reject("malformed", type(fields).__name__)
    if type(fields) is not tuple or not fields or fields[0] != WIRE_VERSION or type(fields[0]) is not int:
        return reject("version", f"wire version {_named(fields)}, this is {WIRE_VERSION}")
    if header is None:
        return reject("malformed", "header")
    if foreign := _foreign(header, topic, cell):
        return reject(*foreign)
    body = _shape(topic.message)(fields[-1])
    if body is None:
        return reject("malformed", f"body of {topic.key}")
    if topic.problem is not None and (what := topic.problem(body)):
        return reject("malformed", f"{topic.key}: {what}")
    return Received(arrival_ns, topic.key, header, body)


def _foreign(header: Header, topic: Topic, cell: str) -> tuple[str, str] | None:
    """Cause and detail if a frame belongs to another schema, cell or sender."""
    if header.schema != topic.schema:
        return "schema", f"schema {header.schema}, {topic.key} is {topic.schema}"
    if header.cell != cell:
        return "cell", f"cell {header.cell[:MAX_NAME]}, this is {cell}"
    if topic.publisher and header.sender != topic.publisher:
        return "sender", f"sender {header.sender[:MAX_NAME]}, expected {topic.publisher}"
    return None


def _unpacked(packed: bytes) -> Any:
    """What the bytes hold; the exception, as a value, if they are no MessagePack."""
    try:
        return msgpack.unpackb(packed, use_list=False, max_ext_len=0, max_map_len=0)
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        return error


def _named(fields: Any) -> str:
    """What stands in the version's place; a tuple by its type alone, for its own text could be nested too deep to be written."""
    found = fields[0] if type(fields) is tuple and fields else fields
    return str(found)[:MAX_NAME] if isinstance(found, int | float | str | bytes) else type(found).__name__


class FieldSpec(NamedTuple):
    """How one field of a message must be on the wire."""

    position: int
    kind: type  # of the value; tuple for an array and for messages inside
    items: tuple[type, ...] = ()  # of an array: kind of each scalar
    check: Callable[[Any], Any] | None = None  # of messages inside: the value as messages, or None


def _field_spec(position: int, hint: Any) -> FieldSpec:
    if hasattr(hint, "_fields"):
        return FieldSpec(position, tuple, check=_shape(hint))
    if isinstance(hint, type):
        return FieldSpec(position, hint)
    if get_origin(hint) is Annotated:
        kind, length = get_args(hint)
        return FieldSpec(position, tuple, items=(get_args(kind)[0],) * length.min_length)
    return FieldSpec(position, tuple, check=_messages(_shape(get_args(hint)[0])))


@cache
def _shape(message: Any) -> Callable[[Any], Any]:
    """Checker and builder for one message class: the message, or None if anything differs.

    Type-strict: a bool is no int, an int is no float. An int fits 64 bits with a sign.
    """
    fields = [_field_spec(position, hint) for position, hint in enumerate(get_type_hints(message, include_extras=True).values())]
    kinds = tuple(field.kind for field in fields)
    inner = [(field.position, field.check) for field in fields if field.check is not None]
    arrays = [field for field in fields if field.items]
    lengths = tuple(len(field.items) for field in arrays)
    items = tuple(item for field in arrays for item in field.items)
    array_values = _picker([field.position for field in arrays])
    integers = _picker([index for index, kind in enumerate(kinds + items) if kind is int])

    def build(values: Any) -> Any:
        if type(values) is not tuple or tuple(map(type, values)) != kinds:
            return None
        flat = values
        if arrays:  # all of them at once: a check of each would cost ten times as much
            found = array_values(values)
            flat += tuple(chain.from_iterable(found))
            if tuple(map(len, found)) != lengths or tuple(map(type, flat[len(kinds) :])) != items:
                return None
        if not _fit(integers(flat)):
            return None
        return _built(message, values, inner) if inner else tuple.__new__(message, values)

    return build


def _fit(values: tuple[int, ...]) -> bool:
    """Whether every int fits 64 bits with a sign; msgpack carries larger ones, but no smaller."""
    return not values or max(values) < _INT64


def _picker(indices: list[int]) -> Callable[[Any], tuple[Any, ...]]:
    """Takes the elements at `indices`, as a tuple whatever their number."""
    if len(indices) == 1:
        (index,) = indices
        return itemgetter(slice(index, index + 1))
    return itemgetter(*indices) if indices else itemgetter(slice(0))


def _built(message: Any, values: tuple[Any, ...], inner: list[tuple[int, Callable[[Any], Any]]]) -> Any:
    """A message with others inside; None if one of those is not as it should be."""
    fields = list(values)
    for position, check in inner:
        if (checked := check(values[position])) is None:
            return None
        fields[position] = checked
    return message._make(fields)


def _messages(build: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Checker of any number of messages of one kind."""

    def check(value: Any) -> Any:
        built = tuple(map(build, value))
        return None if None in built else built

    return check


_header = _shape(Header)
