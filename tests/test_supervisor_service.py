"""The supervisor's shell without a network: what it answers, and what it publishes."""

import json

import pytest
from supervisor_scene import ABOUT, sample
from wire_scene import FakeBus, header

from services.supervisor import service
from services.supervisor.service import Supervisor
from shared.bus import Request
from shared.codec import Received
from shared.envelope import seal
from shared.messages import Mode


class Scene:
    """A supervisor that has heard of the plant, and a plant that is judged sample by sample."""

    def __init__(self):
        self.bus = FakeBus()
        self.supervisor = Supervisor(self.bus)
        self.supervisor._learn(ABOUT)
        self.number = 0
        self.judge()

    def judge(self):
        run = self.bus.run
        self.number += 1
        head = header("plant/sample", self.number, run=run.run, experiment=run.experiment)
        self.supervisor.sample = Received(0, "plant/sample", head, sample(self.number))
        ready = type("Body", (), {"ready": 1})()
        self.supervisor.controller = Received(0, "controller/state", head, ready)
        self.supervisor._judge(self.supervisor.sample, 0)

    def ask(self, verb, **arguments):
        answers = []
        self.supervisor._serve(Request(verb, arguments, lambda *answer: answers.append(answer)))
        if not answers:
            self.judge()
        return answers[0]

    def load(self, **supervisor):
        text = seal({"supervisor": supervisor}, run=7, seed=1, clock="real", bias_ticks=8, duration_ticks=100)
        return self.ask("load", envelope=text)

    def commit(self, values):
        return self.ask("commit", digest=values["digest"])

    def armed(self):
        self.commit(self.load()[2])
        return self.ask("arm")


def test_every_verdict_is_published_with_the_echo_of_the_sample_it_judged():
    scene = Scene()
    key, permit, echo = scene.bus.published[-1]
    assert (key, permit.mode, echo) == ("supervisor/permit", Mode.DISARMED, (1, 4_500_000))
    assert len(scene.bus.published) == 1


def test_arming_is_refused_in_words_without_an_experiment_and_granted_with_one():
    scene = Scene()
    accepted, reason, _ = scene.ask("arm")
    assert not accepted
    assert "no experiment is loaded" in reason
    assert scene.armed()[0]
    assert scene.bus.run.run == 7
    assert scene.bus.run.arming != 0


def test_every_arming_has_a_number_of_its_own():
    scene, numbers = Scene(), set()
    scene.commit(scene.load()[2])
    for _ in range(20):
        assert scene.ask("arm")[0]
        numbers.add(scene.bus.run.arming)
        scene.ask("stop")
        assert scene.bus.run.arming == 0
    assert len(numbers) == 20


def test_neither_load_nor_commit_is_taken_while_armed_or_running():
    scene = Scene()
    loaded = scene.load()[2]
    scene.commit(loaded)
    scene.ask("arm")
    arming = scene.bus.run.arming
    for _ in range(2):
        for accepted, reason, _ in (scene.load(), scene.commit(loaded)):
            assert not accepted
            assert "stop or reset first" in reason
        assert scene.bus.run.arming == arming
        scene.ask("start")
    assert scene.supervisor.memory.mode == Mode.RUNNING


def test_a_commit_without_its_load_is_refused():
    scene = Scene()
    assert not scene.ask("commit", digest="00")[0]
    scene.load()
    assert not scene.ask("commit", digest="00")[0]


def test_an_emergency_stop_does_not_wait_for_a_sample():
    scene = Scene()
    scene.armed()
    before = scene.number
    assert scene.ask("estop")[0]
    assert scene.number == before
    assert scene.bus.of("supervisor/permit")[-1].mode == Mode.TRIPPED
    assert scene.bus.run.arming == 0


@pytest.mark.parametrize(
    ("supervisor", "field"),
    [
        ({"force_limit_n": 335.0}, "force_limit_n"),
        ({"workspace_low_m": [-2.0, -2.0, -1.7]}, "workspace_low_m"),
        ({"workspace_high_m": [2.0, 2.1, 0.8]}, "workspace_high_m"),
        ({"joint_high_rad": [0.0, 0.48, 1.0]}, "joint_high_rad"),
        ({"bias_limit_n": 61.0}, "bias_limit_n"),
    ],
)
def test_an_experiment_may_tighten_a_limit_and_not_widen_it(supervisor, field):
    accepted, reason, _ = Scene().load(**supervisor)
    assert not accepted
    assert f"supervisor.{field}" in reason
    assert Scene().load(force_limit_n=100.0, workspace_low_m=[0.0, -1.0, -1.0])[0]


def test_a_request_that_is_unknown_is_refused_by_name():
    accepted, reason, _ = Scene().ask("dance")
    assert not accepted
    assert "'dance'" in reason
    assert json.dumps(Scene().supervisor.status())


@pytest.mark.parametrize(("clock", "patient_ns"), [("real", 20_000_000), ("lockstep", 6_000_000_000)])
def test_a_request_to_a_cell_without_a_plant_is_answered_and_never_acts_later(monkeypatch, clock, patient_ns):
    scene, answers = Scene(), []
    text = seal({}, run=7, seed=1, clock=clock, bias_ticks=8, duration_ticks=100)
    scene.commit(scene.ask("load", envelope=text)[2])
    scene.supervisor._serve(Request("arm", {}, lambda *answer: answers.append(answer)))
    monkeypatch.setattr(service.time, "monotonic_ns", lambda: patient_ns)
    scene.supervisor._judge_absence()
    assert not answers
    monkeypatch.setattr(service.time, "monotonic_ns", lambda: patient_ns + 1)
    scene.supervisor._judge_absence()
    assert [accepted for accepted, _, _ in answers] == [False]
    scene.judge()
    assert scene.supervisor.memory.mode == Mode.DISARMED


def test_what_came_is_told_once_a_second_and_at_a_trip():
    scene = Scene()
    scene.armed()
    for _ in range(300):
        scene.judge()
    assert [told.number for told in scene.bus.of("supervisor/reception")] == [222]
    scene.ask("estop")
    told = scene.bus.of("supervisor/reception")[-1]
    assert told.number == scene.number
    assert [inbox.topic for inbox in told.inboxes] == ["plant/sample", "controller/state", "plant/about"]
