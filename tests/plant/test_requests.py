"""What the plant answers when it is asked to break, and a device that cannot."""

import os

import pytest

from hydrohil.services.plant.config import GateLimits, PlantConfig
from hydrohil.services.plant.counters import Counters
from hydrohil.services.plant.device import Timeline
from hydrohil.services.plant.gatekeeper import Gatekeeper
from hydrohil.services.plant.plant_clock import PlantClock
from hydrohil.services.plant.requests import PlantRequests
from hydrohil.services.plant.trial import Schedule
from hydrohil.shared.contract.envelope import seal, unseal
from hydrohil.shared.contract.faults import MOST_FAULTS, Fault
from hydrohil.shared.host import realtime, two_phase_load
from hydrohil.shared.transport.live_faults import LiveFaults
from hydrohil.shared.transport.requests import Request
from tests.support.wire_scene import FakeBus

STUCK = {"kind": "stuck", "target": "force"}
WHOLE = {"plant": {}, "faults": [STUCK]}


class Machine:
    """A device that keeps its faults and loads; `reason` is why it takes no fault."""

    def __init__(self, reason=""):
        self.reason, self.injected, self.driven, self.loads = reason, [], None, []

    def refuses(self, faults):
        return self.reason if faults else ""

    def inject(self, fault):
        self.injected.append(fault)

    def clear(self):
        self.injected = []

    def faults(self):
        return tuple(self.injected), ()

    def load(self, *arguments):
        self.loads.append(arguments)

    def write(self, codes):
        pass

    def readback(self):
        return self.driven


class Plant:
    """Requests to a plant at sample 70 that runs no trial, with a gatekeeper that keeps what it was asked."""

    def __init__(self, device):
        timeline = Timeline()
        self.device, self.bus, self.clock = device, FakeBus("plant"), PlantClock(timeline)
        self.keeper = Gatekeeper(self.bus, device, timeline, GateLimits(), Counters())
        self.loads = []
        self.requests = PlantRequests(
            self.bus,
            device,
            self.keeper,
            self.clock,
            LiveFaults(self.bus),
            loaded=lambda: self.loads.append(self.bus.run),
            status=lambda: {"tick": None},
        )
        timeline.number = 70

    def ask(self, verb, **arguments):
        answers = []
        self.requests.answer(Request(verb, arguments, lambda *answer: answers.append(answer)))
        return answers[0]


def asked(device, verb, **arguments):
    return Plant(device).ask(verb, **arguments)


def text(experiment, clock="lockstep"):
    return seal(experiment, run=1, seed=1, clock=clock, tare_ticks=100, duration_ticks=50)


def test_a_fault_by_hand_begins_at_the_sample_that_the_answer_names():
    device = Machine()
    assert asked(device, "inject", fault=STUCK) == (True, "", {"number": 71})
    assert asked(device, "inject", fault=STUCK | {"at_s": 0.45}) == (True, "", {"number": 171})
    assert device.injected == [Fault("stuck", "force"), Fault("stuck", "force", 0.45)]
    assert asked(device, "clear") == (True, "", {})
    assert device.injected == []


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        (None, "fault is None"),
        ({}, "fault.kind"),
        (STUCK | {"kind": "explode"}, "expected one of stuck"),
        (STUCK | {"value": 1.0}, "takes none"),
        (STUCK | {"at_s": -0.1}, "expected 0 or later"),
        (STUCK | {"lasts_s": "long"}, "fault.lasts_s"),
        ({"kind": "leak", "target": "valve_rotate", "value": 0.9}, "expected 1..1000"),
        ({"kind": "drop", "target": "supply"}, "value of drop is missing"),
    ],
)
def test_a_fault_that_the_table_does_not_know_is_refused_by_the_plant_itself(fault, words):
    device = Machine()
    accepted, reason, _ = asked(device, "inject", fault=fault)
    assert not accepted and words in reason and "\n" not in reason
    assert device.injected == []


def test_more_faults_than_a_sample_has_time_for_are_refused():
    device = Machine()
    device.injected = [Fault("stuck", "force")] * (MOST_FAULTS - 1)
    assert asked(device, "inject", fault=STUCK)[0]
    accepted, reason, _ = asked(device, "inject", fault=STUCK)
    assert not accepted and "--clear" in reason


def test_a_device_that_cannot_break_refuses_the_fault_and_the_load():
    real = Machine("a real machine is not broken by a program")
    assert asked(real, "inject", fault=STUCK) == (False, real.reason, {})
    assert asked(real, "load", envelope=text(WHOLE)) == (False, real.reason, {})
    assert asked(real, "load", envelope=text({"plant": {}}))[0]
    assert real.injected == []


def test_a_load_with_a_fault_that_its_clock_cannot_play_is_refused():
    kill = {"faults": [{"kind": "kill", "target": "controller"}]}
    assert "only on real" in asked(Machine(), "load", envelope=text(kill))[1]
    assert asked(Machine(), "load", envelope=text(WHOLE))[0]
    assert Schedule(PlantConfig(), unseal(text(WHOLE))).faults == (Fault("stuck", "force"),)


def test_a_lockstep_commit_after_an_injection_is_refused_before_anything_is_loaded():
    plant = Plant(Machine())
    digest = plant.ask("load", envelope=text({"plant": {}}))[2]["digest"]
    loss = Fault("loss", "supervisor>plant", value=0.5)
    plant.bus.conditions.inject(((loss, 70),))
    before = plant.clock.schedule
    accepted, reason, _ = plant.ask("commit", digest=digest)
    assert not accepted and "--clear" in reason
    assert plant.clock.schedule is before and not plant.loads


def test_a_commit_loads_the_device_and_describes_the_machine_under_the_new_run():
    plant = Plant(Machine())
    digest = plant.ask("load", envelope=text(WHOLE))[2]["digest"]
    assert plant.device.loads == [] and plant.loads == []
    assert plant.ask("commit", digest=digest) == (True, "", {"digest": digest})
    ((config, seed, first_tick, ticks, faults),) = plant.device.loads
    assert (config, seed, first_tick + ticks, faults) == (PlantConfig(), 1, 50, (Fault("stuck", "force"),))
    assert plant.clock.schedule.lockstep and [run.run for run in plant.loads] == [1]


@pytest.mark.skipif(not hasattr(os, "SCHED_FIFO"), reason="this system has no SCHED_FIFO")
def test_the_noise_of_a_trial_is_drawn_without_real_time_scheduling(monkeypatch):
    plant, done = Plant(Machine()), []
    digest = plant.ask("load", envelope=text(WHOLE))[2]["digest"]
    monkeypatch.setattr(realtime, "_granted", [realtime.FIFO_PRIORITY])
    monkeypatch.setattr(two_phase_load, "set_scheduling", lambda clock: None)
    monkeypatch.setattr(os, "sched_getscheduler", lambda _: os.SCHED_FIFO)
    monkeypatch.setattr(os, "sched_setscheduler", lambda _, policy, __: done.append(policy))
    plant.device.load = lambda *_: done.append("noise")
    assert plant.ask("commit", digest=digest)[0]
    assert done == [os.SCHED_OTHER, "noise", os.SCHED_FIFO]


def test_while_a_trial_is_armed_nothing_is_loaded(monkeypatch):
    plant = Plant(Machine())
    digest = plant.ask("load", envelope=text(WHOLE))[2]["digest"]
    monkeypatch.setattr(plant.keeper, "armed", lambda now_ns: True)
    refused = (False, "a trial is armed or running: stop it first (`hydrohil stop`)", {})
    assert plant.ask("load", envelope=text(WHOLE)) == plant.ask("commit", digest=digest) == refused
    assert plant.device.loads == []


@pytest.mark.parametrize("driven", [None, (2048, 2048, 2700)])
def test_an_emergency_stop_is_judged_by_the_plants_own_clock_and_answered_with_what_drives_the_valves(monkeypatch, driven):
    plant, stopped = Plant(Machine()), []
    plant.device.driven = driven
    monkeypatch.setattr(plant.clock, "now_ns", lambda: 123)
    monkeypatch.setattr(plant.keeper, "stop", stopped.append)
    assert plant.ask("estop") == (True, "", {"dac_counts": [2048] * 3, "dac_readback": driven and list(driven)})
    assert stopped == [123]


def test_a_reset_releases_the_stop():
    plant = Plant(Machine())
    plant.ask("estop")
    assert plant.ask("status")[2]["estop"]
    assert plant.ask("reset") == (True, "", {})
    assert not plant.ask("status")[2]["estop"]


def test_the_status_has_the_plants_part_the_gates_and_the_faults():
    device = Machine()
    device.injected = [Fault("stuck", "force")]
    status = asked(device, "status")[2]
    assert (status["tick"], status["gate_cause"], status["dac_counts"]) == (None, "NO_PERMIT", [2048] * 3)
    assert [fault["kind"] for fault in status["faults"]["acting"]] == ["stuck"] and status["faults"]["waiting"] == []


def test_an_unknown_request_is_refused_with_those_that_there_are():
    accepted, reason, _ = asked(Machine(), "dance")
    assert not accepted and "no request 'dance'" in reason and "load, commit, estop" in reason
