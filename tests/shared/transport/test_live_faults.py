import time

import pytest

from hydrohil.shared.contract.envelope import seal, unseal
from hydrohil.shared.contract.faults import MOST_FAULTS
from hydrohil.shared.contract.topics import BY_KEY
from hydrohil.shared.transport.impairment_conditions import Conditions
from hydrohil.shared.transport.live_faults import LiveFaults
from hydrohil.shared.transport.requests import Request
from tests.support.wire_scene import FakeBus


class Scene:
    """A supervisor's inboxes and what is broken of them."""

    def __init__(self):
        self.bus = FakeBus()
        self.states = self.bus.subscribe("controller/state")
        self.faults = LiveFaults(self.bus)

    def ask(self, verb, **fault):
        answers = []
        arguments = {"fault": fault} if fault else {}
        self.faults.answer(Request(verb, arguments, lambda *answer: answers.append(answer)), 41)
        return answers[0]


def test_a_path_that_ends_here_is_broken_from_the_next_sample_on():
    scene = Scene()
    assert scene.ask("inject", kind="loss", target="controller>supervisor", value=0.5) == (True, "", {"number": 42})
    assert scene.states.impairment_queue is not None
    assert [fault["target"] for fault in scene.faults.acting()] == ["controller>supervisor"]


def test_a_cut_that_ends_here_too_is_broken():
    assert Scene().ask("inject", kind="partition", target="plant-supervisor")[0]


def test_clear_mends_everything():
    scene = Scene()
    scene.ask("inject", kind="partition", target="controller>supervisor")
    scene.ask("inject", kind="slow", target="supervisor", value=1.0)
    scene.ask("clear")
    assert scene.faults.acting() == []
    assert not scene.bus.conditions.touches(BY_KEY["controller/state"])


@pytest.mark.parametrize(
    ("fault", "why"),
    [
        ({"kind": "loss", "target": "controller>plant", "value": 0.5}, "not played by the supervisor"),
        ({"kind": "slow", "target": "plant", "value": 1.0}, "not played by the supervisor"),
        ({"kind": "stuck", "target": "force"}, "not played by the supervisor"),
        ({"kind": "loss", "target": "controller>supervisor", "value": 1.5}, "expected 0..1"),
        ({"kind": "loss", "target": "controller>supervisor", "value": 0.5, "at_s": -1.0}, "expected 0 or later"),
        ({"kind": "loss"}, "target"),
        ({"kind": "loss", "target": "controller>supervisor"}, "value of loss is missing"),
    ],
)
def test_what_cannot_be_played_is_refused_with_the_reason(fault, why):
    scene = Scene()
    accepted, reason, _ = scene.ask("inject", **fault)
    assert not accepted and why in reason
    assert scene.faults.acting() == []


def test_nothing_is_injected_into_a_lockstep_trial():
    scene = Scene()
    scene.bus.impair(Conditions("supervisor", (), seed=1, period=90, ticks=(0, 9), lockstep=True))
    accepted, reason, _ = scene.ask("inject", kind="loss", target="controller>supervisor", value=0.5)
    assert not accepted and "schedule it" in reason


def test_a_slow_service_spends_its_time_and_no_longer_than_asked():
    scene = Scene()
    scene.ask("inject", kind="slow", target="supervisor", value=20.0, lasts_s=0.05)
    began = time.monotonic()
    scene.faults.spend()
    assert time.monotonic() - began >= 0.02
    time.sleep(0.05)
    scene.faults.spend()
    assert scene.faults.acting() == []


def test_the_answer_for_a_fault_that_waits_names_the_sample_at_which_it_begins():
    answer = Scene().ask("inject", kind="loss", target="controller>supervisor", value=0.5, at_s=0.45)
    assert answer == (True, "", {"number": 142})


def test_more_faults_than_a_sample_has_time_for_are_refused():
    scene, loss = Scene(), {"kind": "loss", "target": "controller>supervisor", "value": 0.5}
    assert all(scene.ask("inject", **loss)[0] for _ in range(MOST_FAULTS))
    accepted, reason, _ = scene.ask("inject", **loss)
    assert not accepted and "--clear" in reason
    assert len(scene.faults.acting()) == MOST_FAULTS


def test_a_second_pace_does_not_silently_take_the_place_of_the_first(monkeypatch):
    scene, slow = Scene(), {"kind": "slow", "target": "supervisor", "value": 1.0, "lasts_s": 1.0}
    monkeypatch.setattr(time, "monotonic_ns", lambda: now_ns)
    now_ns = 5
    assert scene.ask("inject", **slow)[0]
    now_ns += 999_999_999
    accepted, reason, _ = scene.ask("inject", **slow)
    assert not accepted and "slow already" in reason
    now_ns += 1
    assert scene.ask("inject", **slow)[0]


def test_delays_by_hand_that_add_up_to_more_than_a_second_on_one_path_are_refused():
    scene, late = Scene(), {"kind": "delay", "target": "controller>supervisor", "value": 500.0}
    assert scene.ask("inject", **late)[0] and scene.ask("inject", **late)[0]
    accepted, reason, _ = scene.ask("inject", **late | {"kind": "jitter", "value": 0.5})
    assert not accepted and "1000.5 ms, at most 1000" in reason and "--clear" in reason
    assert scene.ask("inject", **late | {"target": "plant>supervisor"})[0]


def envelope(clock):
    return unseal(seal({}, run=1, seed=1, clock=clock, tare_ticks=8, duration_ticks=100))


@pytest.mark.parametrize(("later_ns", "acts"), [(1, True), (1_999_999_999, True), (2_000_000_000, False)])
def test_lockstep_is_refused_while_a_service_is_slow_by_hand_and_real_is_not(monkeypatch, later_ns, acts):
    scene, now_ns = Scene(), [5]
    monkeypatch.setattr(time, "monotonic_ns", lambda: now_ns[0])
    assert scene.ask("inject", kind="slow", target="supervisor", value=1.0, at_s=1.0, lasts_s=1.0)[0]
    now_ns[0] += later_ns
    assert not scene.faults.loaded(envelope("real")).lockstep
    if acts:
        with pytest.raises(ValueError, match=r"the supervisor is slow still, or will be.*--clear"):
            scene.faults.loaded(envelope("lockstep"))
    else:
        assert scene.faults.loaded(envelope("lockstep")).lockstep
