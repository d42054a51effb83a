import math
import struct
from types import SimpleNamespace
from typing import Annotated, get_args, get_origin, get_type_hints

import msgpack
import numpy as np
import pytest
from annotated_types import Len
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hydrohil.shared.contract.codec import (
    MAX_FRAME_BYTES,
    MAX_REQUEST_BYTES,
    WIRE_VERSION,
    Header,
    Received,
    Rejected,
    crc,
    decode,
    encode,
)
from hydrohil.shared.contract.messages import Command, InboxCounts, PlantDescription
from hydrohil.shared.contract.topics import BY_KEY, BY_SCHEMA, expression
from tests.support.machines import description
from tests.support.wire_scene import CELL, command_body, header

COMMAND = BY_KEY["controller/command"]
KEY = expression(CELL, COMMAND.key)
FRAME = encode(KEY, header(COMMAND.key), command_body((820, 2048, 3276)))
INT64 = st.integers(-(2**63), 2**63 - 1)


def any_of(hint):
    """Values of a field's type, by its annotation."""
    if get_origin(hint) is Annotated:
        kind, *bounds = get_args(hint)
        length = next(bound.min_length for bound in bounds if isinstance(bound, Len))
        return st.tuples(*[any_of(get_args(kind)[0])] * length)
    if get_origin(hint) is tuple:
        return st.lists(any_of(get_args(hint)[0]), max_size=4).map(tuple)
    if hint is PlantDescription:  # one that can be used: any other is refused
        return st.builds(description, period_ns=st.integers(1, 10**9), force_axis=st.sampled_from((0, 1, 2)))
    if hasattr(hint, "_fields"):
        return st.builds(hint, *[any_of(h) for h in get_type_hints(hint, include_extras=True).values()])
    return {int: INT64, float: st.floats(), str: st.text(max_size=20), bytes: st.binary(max_size=20)}[hint]


def read(frame, topic=COMMAND, cell=CELL, key=KEY):
    return decode(key, topic, cell, frame, 5)


def sealed(fields, key=KEY):
    packed = msgpack.packb(fields)
    return packed + crc(key, packed)


def with_body(body):
    return sealed([*header(COMMAND.key), body])


def bits(value):
    return struct.pack("<d", value) if isinstance(value, float) else value


def flat(value):
    return [bits(leaf) for item in value for leaf in (flat(item) if isinstance(item, tuple) else [item])]


@pytest.mark.parametrize("topic", BY_SCHEMA.values(), ids=lambda topic: topic.key)
@settings(max_examples=25, deadline=None)
@given(st.data())
def test_every_message_survives_the_wire_with_every_bit(topic, data):
    body = data.draw(any_of(topic.message))
    head = data.draw(any_of(Header))._replace(version=1, schema=topic.schema, cell=CELL)
    head = head._replace(sender=topic.publisher or head.sender)
    key = expression(CELL, topic.key)
    got = decode(key, topic, CELL, encode(key, head, body), 5)
    assert isinstance(got, Received)
    assert (got.arrival_ns, got.topic, got.header) == (5, topic.key, head)
    assert type(got.body) is type(body)
    assert flat(got.body) == flat(body)


def test_every_flipped_bit_of_a_frame_is_a_checksum_error():
    for bit in range(8 * len(FRAME)):
        flipped = bytearray(FRAME)
        flipped[bit // 8] ^= 1 << bit % 8
        assert read(bytes(flipped)).cause == "crc", bit


def test_every_truncated_frame_is_rejected():
    causes = [read(FRAME[:length]).cause for length in range(len(FRAME))]
    assert causes[:5] == ["malformed"] * 5
    assert set(causes[5:]) == {"crc"}
    assert read(FRAME + b"\0").cause == "crc"


def test_a_version_nested_too_deep_to_be_written_is_rejected_and_not_raised():
    packed = b"\x9c" + b"\x91" * 1020 + b"\x90" + b"\x00" * 11
    key = expression(CELL, COMMAND.key)
    found = read(packed + crc(key, packed), key=key)
    assert (found.cause, found.detail) == ("version", "wire version tuple, this is 1")


def test_a_frame_replayed_on_another_key_is_corrupt():
    assert read(FRAME, key=expression("other", COMMAND.key)).cause == "crc"
    assert decode(expression(CELL, "plant/sample"), BY_KEY["plant/sample"], CELL, FRAME, 0).cause == "crc"


@pytest.mark.parametrize(
    ("changes", "cause", "named"),
    [
        ({"version": 2}, "version", "2"),
        ({"version": True}, "version", "True"),
        ({"version": 1.0}, "version", "1.0"),
        ({"schema": 6}, "schema", "6"),
        ({"cell": "left"}, "cell", "left"),
        ({"sender": "plant"}, "sender", "plant"),
        ({"epoch": 2.0}, "malformed", "header"),
        ({"arming_id": True}, "malformed", "header"),
        ({"seq": None}, "malformed", "header"),
        ({"experiment": "text"}, "malformed", "header"),
        ({"cell": b"cell"}, "malformed", "header"),
        ({"run": 2**63}, "malformed", "header"),
    ],
)
def test_a_header_that_is_not_ours_is_refused_by_name(changes, cause, named):
    got = read(sealed([*header(COMMAND.key)._replace(**changes), ((2048, 2048, 2048),)]))
    assert isinstance(got, Rejected)
    assert got.cause == cause
    assert named in got.detail


@pytest.mark.parametrize(
    "body",
    [
        ([2048, 2048],),
        ([2048, 2048, 2048, 2048],),
        ([],),
        ([2048, 2048, 2048.0],),
        ([2048, 2048, math.nan],),
        ([2048, 2048, True],),
        ([2048, 2048, None],),
        ([2048, 2048, "2048"],),
        ([2048, 2048, 2**63],),
        ([2048, 2048, [2048]],),
        (2048,),
        (None,),
        ([2048, 2048, 2048], 0),
        (),
    ],
    ids=str,
)
def test_a_body_that_differs_in_length_or_type_is_malformed(body):
    assert read(with_body(body)).cause == "malformed"


@pytest.mark.parametrize("body", [None, 5, "text", b"bytes", {}])
def test_a_body_that_is_no_array_is_malformed(body):
    assert read(with_body(body)).cause == "malformed"


COUNTS = ["controller/command", *[0] * (len(InboxCounts._fields) - 1)]


@pytest.mark.parametrize("wrong", [COUNTS[:-1], [*COUNTS, 0], [*COUNTS[:-1], 0.0], [*COUNTS[:-1], True], [], 5, None, "text"])
def test_a_message_is_malformed_if_one_inside_it_is(wrong):
    topic = BY_KEY["plant/link_stats"]
    key = expression(CELL, topic.key)

    def with_inboxes(*inboxes):
        return decode(key, topic, CELL, sealed([*header(topic.key), [5, inboxes]], key), 0)

    assert with_inboxes(COUNTS, COUNTS).body == (5, (tuple(COUNTS), tuple(COUNTS)))
    for inboxes in ((wrong,), (COUNTS, wrong), (wrong, COUNTS)):
        assert with_inboxes(*inboxes).cause == "malformed"


def with_one_int(hint, value):
    """Values of a field's type in which everything is zero or empty but one int, each in turn; a hint without ints has none."""
    if hint is int:
        yield value
        return
    parts = parts_of(hint)
    for i, part in enumerate(parts):
        for changed in with_one_int(part, value):
            yield tuple(changed if j == i else zero(other) for j, other in enumerate(parts))


def parts_of(hint):
    if get_origin(hint) is Annotated:
        kind, *bounds = get_args(hint)
        return [get_args(kind)[0]] * next(bound.min_length for bound in bounds if isinstance(bound, Len))
    if get_origin(hint) is tuple:
        return [get_args(hint)[0]] * 2
    return list(get_type_hints(hint, include_extras=True).values()) if hasattr(hint, "_fields") else []


def zero(hint):
    return hint() if hint in (int, float, str, bytes) else tuple(map(zero, parts_of(hint)))


@pytest.mark.parametrize("topic", BY_SCHEMA.values(), ids=lambda topic: topic.key)
def test_no_int_of_a_message_is_larger_than_64_bits_wherever_it_stands(topic):
    key = expression(CELL, topic.key)
    head = Header(
        version=1,
        schema=topic.schema,
        cell=CELL,
        run=0,
        experiment=b"",
        sender=topic.publisher or "anyone",
        epoch=0,
        arming_id=0,
        seq=0,
        echo_number=0,
        echo_time_ns=0,
    )
    typed = topic._replace(problem=None)  # types alone
    for value, taken in ((2**63 - 1, Received), (2**63, Rejected)):
        for body in with_one_int(topic.message, value):
            assert isinstance(decode(key, typed, CELL, sealed([*head, body], key), 0), taken)


@pytest.mark.parametrize("body", [{"a": 1}, msgpack.ExtType(5, b"x")], ids=str)
def test_maps_and_extensions_are_not_even_unpacked(body):
    assert read(with_body(body))[2:4] == ("malformed", "ValueError")


def test_an_int_is_no_float():
    topic = BY_KEY["plant/gate"]
    key = expression(CELL, topic.key)

    def event(measured):
        return decode(key, topic, CELL, sealed([*header(topic.key), [1, 2, 3, 4, 5, 6, measured, 1.0]], key), 0)

    assert isinstance(event(5.0), Received)
    assert event(5).cause == event(True).cause == "malformed"
    assert math.isnan(event(math.nan).body.measured)


@pytest.mark.parametrize("fields", [[], {}, 5, None, "text", [1], [[1]], [1, 5]], ids=str)
def test_what_is_no_frame_at_all_is_refused(fields):
    assert isinstance(read(sealed(fields)), Rejected)


def test_a_frame_that_holds_no_more_than_a_checksum_is_malformed():
    assert [read(bytes(length)).cause for length in (0, 3, 4, 5)] == ["malformed", "malformed", "malformed", "crc"]
    assert read(bytes(4)).detail == "4 bytes, expected 5 to 4096"


def test_a_frame_may_be_as_long_as_its_limit_and_no_longer():
    assert read(b"x" * MAX_FRAME_BYTES).cause == "crc"
    assert read(b"x" * (MAX_FRAME_BYTES + 1)).cause == "oversized"
    ask = BY_SCHEMA[8]
    assert decode(KEY, ask, CELL, b"x" * MAX_REQUEST_BYTES, 0).cause == "crc"
    assert decode(KEY, ask, CELL, b"x" * (MAX_REQUEST_BYTES + 1), 0).cause == "oversized"


EMPTY_EXTENSION = b"\xc7\x00\x05"  # of length 0, which no limit forbids: no array, so no version


@pytest.mark.parametrize(
    "packed", [b"\x91" * 3000, b"\xdd\xff\xff\xff\xff", b"\xc6\xff\xff\xff\xff", b"\x81\x01\x02", EMPTY_EXTENSION, b"\xc1"]
)
def test_deep_nesting_and_false_lengths_are_rejected_without_an_exception(packed):
    got = read(packed + crc(KEY, packed))
    assert isinstance(got, Rejected)
    assert got.cause == ("version" if packed == EMPTY_EXTENSION else "malformed")


@settings(max_examples=300, deadline=None)
@given(st.binary(max_size=200))
def test_no_bytes_make_the_decoder_raise(noise):
    assert isinstance(read(noise), Rejected)
    assert isinstance(read(noise + crc(KEY, noise)), Rejected)


JUNK = st.recursive(
    st.none() | st.booleans() | INT64 | st.floats() | st.text(max_size=5) | st.binary(max_size=5),
    lambda x: st.lists(x, max_size=4),
)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])  # a busy host is no fault
@given(st.lists(JUNK, min_size=10, max_size=14), st.booleans())
def test_no_array_makes_the_decoder_raise(fields, versioned):
    assert isinstance(read(sealed([1, *fields] if versioned else fields)), Rejected)


def test_numpy_integers_have_no_place_on_the_wire():
    with pytest.raises(TypeError):
        encode(KEY, header(COMMAND.key), Command((np.int64(2048), 2048, 2048)))


def test_the_frame_is_as_the_documentation_says():
    import zlib

    fields = msgpack.unpackb(FRAME[:-4], use_list=False)
    assert fields == (*header(COMMAND.key), ((820, 2048, 3276),))
    assert int.from_bytes(FRAME[-4:], "little") == zlib.crc32(KEY.encode() + b"\0" + FRAME[:-4])
    assert SimpleNamespace(**read(FRAME).header._asdict()).cell == CELL


def test_the_limits_are_those_that_the_documentation_states():
    assert (MAX_FRAME_BYTES, MAX_REQUEST_BYTES, WIRE_VERSION) == (4096, 1024 * 1024, 1)


@pytest.mark.parametrize("changes", [{"cell": "x" * 99}, {"sender": "x" * 99}])
def test_a_foreign_name_is_reported_up_to_64_characters(changes):
    got = read(sealed([*header(COMMAND.key)._replace(**changes), ((2048, 2048, 2048),)]))
    assert got.detail.count("x") in (64, 65)  # "expected" has one
    assert "x" * 64 in got.detail and "x" * 65 not in got.detail
    version = read(sealed(["x" * 99]))
    assert "x" * 64 in version.detail and "x" * 65 not in version.detail


def test_what_could_be_read_of_a_refused_frame_comes_with_it():
    flipped = FRAME[:-1] + bytes([FRAME[-1] ^ 1])
    assert read(flipped).header == header(COMMAND.key)
    assert read(b"\xc1" * 20).header is None
    assert read(sealed([*header(COMMAND.key)._replace(cell="left"), ((2048, 2048, 2048),)])).header.cell == "left"


def test_a_body_of_the_right_types_that_cannot_be_used_is_rejected_with_the_reason():
    topic = BY_KEY["plant/description"]
    key, head = expression(CELL, topic.key), header(topic.key, 0, sender="plant")
    for period_ns, taken in ((4_500_000, Received), (-1, Rejected)):
        body = description()._replace(sample_period_ns=period_ns)
        found = decode(key, topic, CELL, encode(key, head, body), 0)
        assert isinstance(found, taken)
    assert found.cause == "malformed" and "-1 ns apart" in found.detail
