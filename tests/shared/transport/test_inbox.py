"""The ring between transport and step: bounded, stamped on arrival, drained once and in order."""

from types import SimpleNamespace

from hydrohil.shared.contract.codec import Received, encode
from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.contract.messages import NO_COMMAND
from hydrohil.shared.contract.topics import BY_KEY, expression
from hydrohil.shared.transport import inbox as module
from hydrohil.shared.transport.inbox import RING, Inbox
from tests.shared.transport.test_impairment_queue import LATE
from tests.shared.transport.test_impairment_queue import Scene as Impaired
from tests.support.wire_scene import CELL, command_body, header

KEY = "controller/command"


class Scene:
    """An inbox fed with one command a call, and how often it woke its step."""

    def __init__(self, depth=RING):
        self.woken = 0
        self.inbox = Inbox(BY_KEY[KEY], CELL, depth, self.wake)

    def wake(self):
        self.woken += 1

    def put(self, seq, **changes):
        self.put_bytes(encode(expression(CELL, KEY), header(KEY, seq, echo_number=seq, **changes), command_body()))

    def put_bytes(self, frame):
        self.inbox.put(SimpleNamespace(payload=SimpleNamespace(to_bytes=lambda: frame)))


def numbers(frames):
    return [frame.header.echo_number for frame in frames]


def test_what_came_is_taken_once_in_order_and_each_wakes_the_step():
    scene = Scene()
    for seq in (1, 2, 3):
        scene.put(seq)
    assert (numbers(scene.inbox.take()), scene.inbox.take(), scene.woken) == ([1, 2, 3], [], 3)
    assert scene.inbox.number == 3


def test_a_frame_is_stamped_when_it_arrives_and_not_when_it_is_taken(monkeypatch):
    scene = Scene()
    for now_ns in (70, 90):
        monkeypatch.setattr(module.time, "monotonic_ns", lambda now_ns=now_ns: now_ns)
        scene.put(now_ns)
    monkeypatch.setattr(module.time, "monotonic_ns", lambda: 1000)
    assert [message.arrival_ns for message in scene.inbox.take()] == [70, 90]


def test_a_ring_that_is_full_keeps_the_newest():
    scene = Scene(depth=2)
    for seq in (1, 2, 3):
        scene.put(seq)
    assert numbers(scene.inbox.take()) == [2, 3]
    assert (RING, scene.inbox.acceptance.lost) == (64, 0)  # of a stream that is new nothing is lost


def test_the_newest_frame_may_be_looked_at_and_stays_where_it_is():
    scene = Scene()
    assert scene.inbox.peek() is None
    scene.put(1)
    scene.put(2)
    assert isinstance(scene.inbox.peek(), Received) and scene.inbox.peek().header.seq == 2
    scene.put_bytes(b"noise")
    assert scene.inbox.peek().cause == "crc"
    assert scene.inbox.acceptance.discarded.total() == 0
    assert numbers(scene.inbox.take()) == [1, 2]


def test_before_anything_came_there_is_no_number_and_without_faults_nothing_is_held():
    scene = Scene()
    assert (scene.inbox.number, scene.inbox.arrived(), scene.inbox.impaired_samples()) == (NO_COMMAND, NO_COMMAND, [])
    scene.put(1)
    assert scene.inbox.delay_ns(scene.inbox.take()[0]) == 0


def test_what_a_fault_holds_stays_held_when_the_same_load_is_named_again_and_comes_no_more_under_another():
    scene = Impaired(KEY, "plant", LATE)
    scene.put(5)
    assert scene.ticks(0) == []
    scene.inbox.impair(scene.conditions)
    assert scene.ticks() == [5]
    scene.put(6)
    assert scene.ticks(0) == []
    scene.inbox.impair(Impaired(KEY, "plant", LATE).conditions)
    assert scene.ticks() == []


def test_a_sample_that_a_fault_took_is_reported_once():
    scene = Impaired("plant/sample", "controller", Fault("burst", "plant>controller", value=1.0))
    scene.put(0)
    assert scene.ticks() == []
    assert [impaired.number for impaired in scene.inbox.impaired_samples()] == [100]
    assert scene.inbox.impaired_samples() == []
