"""A load takes 25 ms of a processor: none of another cell's loop, which may share it."""

import os
from types import SimpleNamespace

import pytest

from hydrohil.services.controller import service as controller
from hydrohil.services.plant import requests as plant
from hydrohil.services.supervisor import service as supervisor
from hydrohil.services.supervisor.modes import DISARMED
from hydrohil.shared.host import realtime
from hydrohil.shared.transport.requests import Request

IDLE = SimpleNamespace(
    description=object(),
    memory=SimpleNamespace(mode=DISARMED),
    keeper=SimpleNamespace(
        gate=SimpleNamespace(arming_id=0), mailbox=SimpleNamespace(observe_permit=lambda _: SimpleNamespace(arming_id=0))
    ),
    now_ns=lambda: 0,
)
LOADS = [(plant, plant._load), (controller, controller.Controller._load), (supervisor, supervisor.Supervisor._load)]


@pytest.fixture
def told(monkeypatch):
    """What was done, and each change of the scheduling in between."""
    done = []
    monkeypatch.setattr(realtime, "_granted", [realtime.FIFO_PRIORITY])
    monkeypatch.setattr(os, "sched_getscheduler", lambda _: os.SCHED_FIFO)
    monkeypatch.setattr(os, "sched_setscheduler", lambda _, policy, __: done.append(policy))
    return done


@pytest.mark.skipif(not hasattr(os, "SCHED_FIFO"), reason="this system has no SCHED_FIFO")
@pytest.mark.parametrize(("module", "load"), LOADS)
def test_a_load_is_read_and_checked_without_real_time_scheduling(module, load, told, monkeypatch):
    def unseal(_):
        told.append("unseal")
        raise ValueError("no envelope")

    answers = []
    monkeypatch.setattr(module, "unseal", unseal)
    load(IDLE, Request("load", {}, lambda *answer: answers.append(answer)))
    assert told == [os.SCHED_OTHER, "unseal", os.SCHED_FIFO]
    assert answers[0][:2] == (False, "no envelope")


@pytest.mark.skipif(not hasattr(os, "SCHED_FIFO"), reason="this system has no SCHED_FIFO")
def test_the_noise_of_a_trial_is_drawn_without_real_time_scheduling(told):
    def load(*_):
        told.append("noise")
        raise InterruptedError

    envelope = SimpleNamespace(digest=b"7", seed=1)
    pending = SimpleNamespace(envelope=envelope, config=None, first_tick=-8, ticks=100, faults=())
    device, faults = SimpleNamespace(load=load), SimpleNamespace(loaded=lambda _: ())
    one = SimpleNamespace(**vars(IDLE), pending=pending, device=device, faults=faults)
    with pytest.raises(InterruptedError):
        plant._commit(one, Request("commit", {"digest": envelope.digest.hex()}, lambda *_: None))
    assert told == [os.SCHED_OTHER, "noise", os.SCHED_FIFO]
