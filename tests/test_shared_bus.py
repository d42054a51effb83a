from types import SimpleNamespace

from wire_scene import CELL, EPOCHS, Query

from shared.bus import Bus
from shared.inbox import RING


def asked(*verbs):
    """Verbs in the order in which a service that was busy meanwhile serves them."""
    bus = Bus("plant", CELL, 7450, EPOCHS["plant"])
    for seq, verb in enumerate(verbs):
        bus._asked(Query("plant", verb, seq))
    return [request.verb for request in bus.requests()]


def test_requests_are_served_in_their_order():
    assert asked("load", "commit", "status") == ["load", "commit", "status"]


def test_an_emergency_stop_goes_before_everything_that_waits():
    assert asked("status", "reset", "estop") == ["estop", "status", "reset"]


def test_a_flood_of_requests_pushes_no_emergency_stop_out_whether_it_comes_before_or_after():
    flood = ["status"] * (3 * RING)
    for served in (asked("estop", *flood), asked(*flood, "estop")):
        assert served[0] == "estop"
        assert len(served) == RING + 1


def test_of_a_flood_those_that_came_first_are_served():
    assert asked("load", *["status"] * RING) == ["load", *["status"] * (RING - 1)]


def test_a_query_without_a_payload_waits_its_turn_and_is_answered():
    bus, told = Bus("plant", CELL, 7450, EPOCHS["plant"]), []
    bus._requests._answer = lambda _query, _key: lambda *answer: told.append(answer[1])
    bus._asked(SimpleNamespace(key_expr="hydrohil/cell/operator/request/plant", payload=None))
    assert bus.requests() == []
    assert told[0].startswith("malformed request")


def test_emergency_stops_are_taken_without_the_rest_and_once():
    bus = Bus("plant", CELL, 7450, EPOCHS["plant"])
    for seq, verb in enumerate(("load", "estop", "status", "estop")):
        bus._asked(Query("plant", verb, seq))
    assert [request.verb for request in bus.stops()] == ["estop", "estop"]
    assert bus.stops() == []
    assert [request.verb for request in bus.requests()] == ["load", "status"]


def test_a_flood_of_requests_that_speak_of_a_stop_ends_at_the_ring():
    bus = Bus("plant", CELL, 7450, EPOCHS["plant"])
    for seq in range(3 * RING):
        bus._asked(Query("plant", "status", seq, said="\u05e5estop"))
    assert bus.stops() == []
    bus._asked(Query("plant", "estop", 3 * RING))
    assert bus.requests()[0].verb == "estop"
