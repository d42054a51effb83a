"""What the plant answers when it is asked to break, and a device that cannot."""

from types import SimpleNamespace

import pytest

from hydrohil.services.plant.config import GateLimits, PlantConfig
from hydrohil.services.plant.requests import answer
from hydrohil.services.plant.trial import Schedule
from hydrohil.shared.contract.envelope import seal, unseal
from hydrohil.shared.contract.faults import MOST_FAULTS, Fault
from hydrohil.shared.transport.impairment_queue import idle
from hydrohil.shared.transport.live_faults import LiveFaults
from hydrohil.shared.transport.requests import Request

STUCK = {"kind": "stuck", "target": "force"}
WHOLE = {"plant": {}, "faults": [STUCK]}


class Machine:
    """A device that is told of faults; `reason` is why it takes none."""

    def __init__(self, reason=""):
        self.reason, self.injected, self.driven = reason, [], None

    def refuses(self, faults):
        return self.reason if faults else ""

    def inject(self, fault):
        self.injected.append(fault)

    def clear(self):
        self.injected = []

    def faults(self):
        return tuple(self.injected), ()

    def readback(self):
        return self.driven


def plant(device):
    keeper = SimpleNamespace(
        gate=SimpleNamespace(arming_id=0),
        limits=GateLimits(),
        mailbox=SimpleNamespace(observe_permit=lambda _: SimpleNamespace(arming_id=0, age_ns=0)),
    )
    timeline, schedule = SimpleNamespace(number=70), Schedule(PlantConfig())
    bus = SimpleNamespace(conditions=idle("plant"))
    return SimpleNamespace(
        device=device,
        keeper=keeper,
        timeline=timeline,
        schedule=schedule,
        now_ns=int,
        bus=bus,
        faults=LiveFaults(bus),
        pending=None,
    )


def asked(device, verb, **arguments):
    told = []
    answer(plant(device), Request(verb, arguments, lambda *given: told.append(given)))
    return told[0]


def text(experiment, clock="lockstep"):
    return seal(experiment, run=1, seed=1, clock=clock, tare_ticks=100, duration_ticks=50)


def test_a_fault_by_hand_begins_at_the_sample_that_is_told():
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
    machine, told = plant(Machine()), []

    def ask(verb, **arguments):
        answer(machine, Request(verb, arguments, lambda *given: told.append(given)))
        return told[-1]

    digest = ask("load", envelope=text({"plant": {}}))[2]["digest"]
    loss = Fault("loss", "supervisor>plant", value=0.5)
    machine.bus.conditions.inject(((loss, machine.timeline.number),))
    before = machine.schedule
    accepted, reason, _ = ask("commit", digest=digest)
    assert not accepted and "--clear" in reason
    assert machine.schedule is before


@pytest.mark.parametrize("driven", [None, (2048, 2048, 2700)])
def test_an_emergency_stop_is_judged_by_the_plants_own_clock_and_tells_what_drives_the_valves(driven):
    machine, told, judged = plant(Machine()), [], []
    machine.device.driven = driven
    machine.keeper.judge = lambda now_ns, at_latch: judged.append(now_ns)
    machine.keeper.gate.codes = (2048, 2048, 2048)
    machine.now_ns = lambda: 123
    answer(machine, Request("estop", {}, lambda *given: told.append(given)))
    assert machine.keeper.estop and judged == [123]
    assert told == [(True, "", {"dac_counts": [2048] * 3, "dac_readback": driven and list(driven)})]
