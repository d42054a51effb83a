"""A reset at the request level: an edge, refused while the cause stands, without effect if held or replayed; it moves nothing."""

from types import SimpleNamespace

from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import Mode, TripCause
from hydrohil.shared.transport.requests import Request
from tests.supervisor.test_service import Scene
from tests.support.supervisor_scene import sample
from tests.support.wire_scene import MACHINE_ID, header

OVER = {"force_counts": 400}  # 540 N


class Tripped(Scene):
    """Tripped by force in the middle of a trial; the cause stands until it is taken away."""

    def __init__(self):
        super().__init__()
        self.sample_changes = {}
        self.armed()
        self.before = self.bus.run.arming_id
        self.ask("start")
        self.sample_changes = OVER
        self.judge()
        assert self.supervisor.memory.mode == Mode.TRIPPED

    def judge(self):
        run = self.bus.run
        self.describe(self.supervisor.cell.description)
        self.number += 1
        changes = getattr(self, "sample_changes", {})
        head = header("plant/sample", self.number, run=run.run, experiment=run.experiment)
        self.supervisor.cell.sample = Received(0, "plant/sample", head, sample(self.number, **changes))
        ready = SimpleNamespace(ready=1, machine_id=MACHINE_ID)
        self.supervisor.cell.controller = Received(0, "controller/state", head, ready)
        self.supervisor._judge(self.supervisor.cell.sample, 0)

    def request(self, verb="reset"):
        """Put a request in the queue; its answers."""
        answers = []
        self.supervisor.requests.answer(Request(verb, {}, lambda *answer: answers.append(answer)))
        return answers

    def unload(self):
        """The cause goes, and the jump of the force as it goes is over."""
        self.sample_changes = {}
        for _ in range(5):
            self.judge()

    @property
    def mode(self):
        return self.supervisor.memory.mode


def test_a_reset_is_refused_in_words_while_the_cause_stands():
    scene = Tripped()
    accepted, reason, _ = scene.ask("reset")
    assert not accepted
    assert "raw force" in reason and "cause must be gone" in reason
    assert scene.mode == Mode.TRIPPED


def test_a_refused_reset_is_spent_and_does_not_act_when_the_cause_has_gone():
    scene = Tripped()
    scene.ask("reset")
    scene.sample_changes = {}
    for _ in range(50):
        scene.judge()
    assert scene.mode == Mode.TRIPPED
    assert scene.supervisor.memory.cause == TripCause.FORCE_RAW


def test_a_held_reset_is_one_reset_and_none_of_it_waits_for_the_cause_to_go():
    scene = Tripped()
    answers = [scene.request() for _ in range(50)]
    scene.judge()
    assert [[accepted for accepted, _, _ in given] for given in answers] == [[False]] * 50
    scene.sample_changes = {}
    for _ in range(60):
        scene.judge()
    assert scene.mode == Mode.TRIPPED


def test_other_requests_behind_a_held_reset_keep_their_turn():
    scene = Tripped()
    scene.request(), scene.request()
    stop = scene.request("stop")
    scene.judge()
    assert not stop
    scene.judge()
    assert len(stop) == 1


def test_a_reset_moves_nothing_and_leaves_no_arming():
    scene = Tripped()
    scene.unload()
    assert scene.ask("reset")[0]
    permit = scene.bus.of("supervisor/permit")[-1]
    assert (permit.mode, permit.recover_signs, scene.bus.run.arming_id) == (Mode.DISARMED, (0, 0, 0), 0)
    for _ in range(20):
        scene.judge()
    assert scene.mode == Mode.DISARMED


def test_after_a_reset_the_next_arming_is_another():
    scene = Tripped()
    scene.unload()
    scene.ask("reset")
    assert scene.ask("arm")[0]
    assert scene.bus.run.arming_id not in (0, scene.before)


def test_a_reset_clears_neither_an_arming_nor_a_trial():
    scene = Scene()
    scene.armed()
    arming_id = scene.bus.run.arming_id
    assert not scene.ask("reset")[0]
    assert (scene.supervisor.memory.mode, scene.bus.run.arming_id) == (Mode.ARMED, arming_id)
    scene.ask("start")
    assert not scene.ask("reset")[0]
    assert scene.supervisor.memory.mode == Mode.RUNNING


def test_a_flood_of_events_is_refused_beyond_what_waits_and_an_emergency_stop_acts_before_all_of_it():
    scene = Tripped()
    waiting = [scene.request("start") for _ in range(64)]
    assert waiting == [[]] * 64
    for _ in range(2):
        ((accepted, reason, _),) = scene.request("stop")
        assert not accepted and "64 requests wait already" in reason
    assert len(scene.request("estop")) == 1
    assert scene.supervisor.memory.cause == TripCause.FORCE_RAW  # the trip that is latched stays the one that is reported
    assert waiting == [[]] * 64
    scene.judge()
    assert [len(answers) for answers in waiting] == [1] + [0] * 63
    assert scene.request("stop") == []


def test_recovery_from_a_pressed_stop_is_refused_in_words_and_granted_after_the_reset_that_a_force_refuses():
    scene = Tripped()
    scene.request("estop")
    accepted, reason, _ = scene.ask("recover")
    assert not accepted and "emergency stop is pressed" in reason and "hydrohil reset" in reason
    assert not scene.ask("reset")[0]
    assert scene.ask("recover")[0]
    assert scene.mode == Mode.RECOVER
