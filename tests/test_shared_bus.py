from types import SimpleNamespace

from shared.bus import Bus
from shared.codec import WIRE_VERSION, Header, encode
from shared.inbox import RING
from shared.messages import Ask
from shared.topics import ASK, expression

CELL = "cell"
KEY = expression(CELL, f"{ASK.key}/plant")


def query(verb, seq):
    head = Header(WIRE_VERSION, ASK.schema, CELL, 0, b"", "operator", 5, 0, seq, -1, 0)
    frame = encode(KEY, head, Ask(verb, b"{}"))
    return SimpleNamespace(key_expr=KEY, payload=SimpleNamespace(to_bytes=lambda: frame))


def asked(*verbs):
    """Verbs in the order in which a service that was busy meanwhile serves them."""
    bus = Bus("plant", CELL, 7450, 1)
    for seq, verb in enumerate(verbs):
        bus._asked(query(verb, seq))
    return [request.verb for request in bus.requests()]


def test_requests_are_served_in_their_order():
    assert asked("load", "commit", "status") == ["load", "commit", "status"]


def test_an_emergency_stop_goes_before_everything_that_waits():
    assert asked("status", "reset", "estop") == ["estop", "status", "reset"]


def test_a_flood_of_requests_pushes_no_emergency_stop_out_whether_it_comes_before_or_after():
    flood = ["status"] * (3 * RING)
    for served in (asked("estop", *flood), asked(*flood, "estop")):
        assert served[0] == "estop"
        assert len(served) == RING


def test_of_a_flood_those_that_came_first_are_served():
    assert asked("load", *["status"] * RING) == ["load", *["status"] * (RING - 1)]


def test_a_query_without_a_payload_waits_its_turn_and_is_answered():
    bus, told = Bus("plant", CELL, 7450, 1), []
    bus._answer = lambda _query, _key: lambda *answer: told.append(answer[1])
    bus._asked(SimpleNamespace(key_expr=KEY, payload=None))
    assert bus.requests() == []
    assert told[0].startswith("malformed request")
