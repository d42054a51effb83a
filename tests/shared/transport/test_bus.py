import random
import threading
import time
from types import SimpleNamespace

import pytest

from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.contract.topics import BY_KEY
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.impairment_conditions import Conditions
from hydrohil.shared.transport.inbox import RING, Inbox
from hydrohil.shared.transport.step_lock import StepLock
from tests.support.wire_scene import CELL, EPOCHS, Query, state_body


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
    bus, reasons = Bus("plant", CELL, 7450, EPOCHS["plant"]), []
    bus._requests._answer = lambda _query, _key: lambda *answer: reasons.append(answer[1])
    bus._asked(SimpleNamespace(key_expr="hydrohil/cell/operator/request/plant", payload=None))
    assert bus.requests() == []
    assert reasons[0].startswith("malformed request")


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


class Stepped:
    """A bus whose step runs where a frame arrives, as the transport's thread would call it."""

    def __init__(self, step):
        self.bus = Bus("controller", CELL, 7450, EPOCHS["controller"])
        self.inbox = Inbox(BY_KEY["plant/sample"], CELL, RING, self.bus._arrived)
        self.bus._inboxes[self.inbox] = None
        self.bus.step_on_arrival(StepLock(step))

    def arrive(self):
        sample = SimpleNamespace(payload=SimpleNamespace(to_bytes=lambda: b"frame"))
        transport = threading.Thread(target=self.inbox.put, args=(sample,), name="transport")
        transport.start()
        transport.join(10.0)


def test_a_step_runs_in_the_thread_that_brings_the_frame_and_no_other_is_woken():
    by = []
    scene = Stepped(lambda: by.append(threading.current_thread().name))
    scene.arrive()
    assert by == ["transport"]
    assert not scene.bus.wait(0.0)


def test_what_a_step_raises_in_the_transport_s_thread_ends_who_waits():
    def step():
        raise ArithmeticError("broken")

    scene = Stepped(step)
    scene.arrive()
    with pytest.raises(ArithmeticError, match="broken"):
        scene.bus.wait(0.0)


def test_while_a_fault_acts_on_a_way_a_frame_wakes_who_knows_when_it_is_to_come():
    by = []
    scene = Stepped(lambda: by.append(1))
    cut = Fault("partition", "plant>controller")
    scene.bus.impair(Conditions("controller", (cut,), seed=1, period=90, ticks=(0, 9), lockstep=False))
    scene.arrive()
    assert by == []
    assert scene.bus.wait(0.0)


@pytest.mark.live
def test_a_thread_of_the_transport_keeps_its_python_state_from_frame_to_frame():
    state, steps, port = threading.local(), [], random.randrange(20_000, 30_000, 4)

    def step():
        state.frames = getattr(state, "frames", 0) + 1
        steps.append((threading.get_native_id(), state.frames))

    with Bus("plant", CELL, port, 1) as plant, Bus("controller", CELL, port, 2) as controller:
        controller.subscribe("controller/state")
        controller.step_on_arrival(StepLock(step))
        deadline = time.monotonic() + 10.0
        while len(steps) < 20 and time.monotonic() < deadline:
            plant.publish("controller/state", state_body())
            time.sleep(0.02)
    threads = {thread for thread, _ in steps}
    assert len(threads) < len(steps)  # one of them, at least, brought two
    for thread in threads:
        counts = [count for other, count in steps if other == thread]
        assert counts == list(range(1, len(counts) + 1))
