"""The two phases of a load: what refuses either of them, what changes with the second, and when real-time scheduling rests."""

import os

import pytest

from hydrohil.shared.contract.envelope import seal
from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.host import realtime, two_phase_load
from hydrohil.shared.host.two_phase_load import Checked, TwoPhaseLoad
from hydrohil.shared.transport.live_faults import LiveFaults
from hydrohil.shared.transport.requests import Request
from tests.support.wire_scene import FakeBus


class Service:
    """A supervisor's bus, and what it was given to check and to take over."""

    def __init__(self):
        self.bus, self.busy, self.problem = FakeBus("supervisor"), "", ""
        self.checked, self.taken = [], []
        self.loading = TwoPhaseLoad(self.bus, LiveFaults(self.bus), busy=lambda: self.busy, check=self.check, take=self.take)

    def check(self, envelope, arguments):
        self.checked.append(arguments)
        if self.problem:
            raise ValueError(self.problem)
        return Checked(envelope.seed, {"warnings": ["soft"]})

    def take(self, envelope, prepared):
        self.taken.append((envelope.run, prepared))

    def ask(self, phase, **arguments):
        answers = []
        phase(Request("", arguments, lambda *answer: answers.append(answer)))
        (answer,) = answers
        return answer

    def load(self, **changes):
        text = seal({}, **({"run": 7, "seed": 3, "clock": "lockstep", "tare_ticks": 8, "duration_ticks": 100} | changes))
        return self.ask(self.loading.load, envelope=text, unqualified=True)

    def commit(self, digest):
        return self.ask(self.loading.commit, digest=digest)


@pytest.fixture
def service():
    return Service()


def test_a_load_changes_nothing_that_runs_and_a_commit_takes_it_over(service):
    accepted, _, answer = service.load()
    assert accepted and answer["warnings"] == ["soft"]
    assert service.checked[0]["unqualified"] is True
    assert (service.taken, service.bus.run.run, service.bus.waits_for_room) == ([], 0, False)
    assert service.commit(answer["digest"]) == (True, "", {"digest": answer["digest"]})
    assert service.taken == [(7, 3)]
    assert (service.bus.run.run, service.bus.run.experiment.hex(), service.bus.run.arming_id) == (7, answer["digest"], 0)
    assert service.bus.waits_for_room and service.bus.conditions.lockstep


def test_on_the_wall_clock_the_bus_drops_rather_than_waits(service):
    digest = service.load(clock="real")[2]["digest"]
    assert service.commit(digest)[0]
    assert not service.bus.waits_for_room


def test_a_commit_needs_the_load_of_its_digest(service):
    refused = (False, "nothing with this hash was loaded: load it first", {})
    assert service.commit("00") == refused
    digest = service.load()[2]["digest"]
    assert service.commit("00") == service.commit(None) == refused
    assert service.commit(digest)[0]


def test_a_later_load_replaces_an_earlier_one(service):
    first, second = (service.load(run=run)[2]["digest"] for run in (1, 2))
    assert not service.commit(first)[0]
    assert service.commit(second)[0] and service.taken == [(2, 3)]


def test_a_busy_service_refuses_both_phases_with_its_reason(service):
    digest = service.load()[2]["digest"]
    service.busy = "the mode is ARMED: stop or reset first"
    assert service.load() == service.commit(digest) == (False, service.busy, {})
    assert len(service.checked) == 1 and service.taken == []


def test_what_the_check_refuses_is_no_load(service):
    service.problem = "plant.bias_s is 0: expected 0.001 or more"
    assert service.load() == (False, service.problem, {})
    assert service.ask(service.loading.load, envelope="no envelope")[0] is False
    assert len(service.checked) == 1


def test_a_fault_that_was_injected_since_the_load_refuses_the_commit(service):
    digest = service.load()[2]["digest"]
    service.bus.conditions.inject(((Fault("loss", "plant>supervisor", value=0.5), 0),))
    accepted, reason, _ = service.commit(digest)
    assert not accepted and "--clear" in reason
    assert service.taken == [] and service.bus.run.run == 0


@pytest.mark.skipif(not hasattr(os, "SCHED_FIFO"), reason="this system has no SCHED_FIFO")
def test_a_load_is_read_and_checked_without_real_time_scheduling(service, monkeypatch):
    """A load takes 25 ms of a processor: none of another cell's loop, which may share it."""
    done = []

    def unseal(_):
        done.append("unseal")
        raise ValueError("no envelope")

    monkeypatch.setattr(realtime, "_granted", [realtime.FIFO_PRIORITY])
    monkeypatch.setattr(os, "sched_getscheduler", lambda _: os.SCHED_FIFO)
    monkeypatch.setattr(os, "sched_setscheduler", lambda _, policy, __: done.append(policy))
    monkeypatch.setattr(two_phase_load, "unseal", unseal)
    assert service.load() == (False, "no envelope", {})
    assert done == [os.SCHED_OTHER, "unseal", os.SCHED_FIFO]
