import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from hydrohil.cell import process_faults
from hydrohil.cell.process_faults import ProcessFaults, carry_out, inject_now, is_service
from hydrohil.cell.processes import CellError, RefusedError
from hydrohil.shared.contract.faults import Fault

CELL = "a-cell-of-this-test"
SLEEPER = "import time\ntime.sleep(60)"


class FakeBus:
    identity = type("Identity", (), {"cell": CELL})


@pytest.fixture
def process():
    """A process whose command line is that of a controller of this cell."""
    child = subprocess.Popen([sys.executable, "-c", SLEEPER, "hydrohil.services.controller", "--cell", CELL])
    until(lambda: is_service(child.pid, "controller", CELL))
    yield child
    child.kill()
    child.wait()


@pytest.fixture
def bus(monkeypatch, process):
    monkeypatch.setattr(process_faults, "statuses", lambda bus, services: {"controller": {"pid": process.pid}})
    return FakeBus()


def until(condition):
    """Until it holds, at most ten seconds; what it gave last."""
    deadline = time.monotonic() + 10.0
    while not (found := condition()) and time.monotonic() < deadline:
        time.sleep(0.01)
    return found


def state(process):
    return Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()[0]


def until_state(process, states):
    until(lambda: state(process) in states)
    return state(process)


def busy():
    """Children of this process that never rest."""
    children = Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").read_text().split()
    return sum(b"range(100_000)" in Path(f"/proc/{child}/cmdline").read_bytes() for child in children)


def test_only_that_service_of_that_cell_is_signalled(process):
    assert is_service(process.pid, "controller", CELL)
    assert not is_service(process.pid, "plant", CELL)
    assert not is_service(process.pid, "controller", "another")
    assert not is_service(os.getpid(), "controller", CELL)
    assert not is_service(2**22 + 1, "controller", CELL)


def test_a_number_that_belongs_to_another_process_now_is_left_alone():
    with pytest.raises(CellError, match="left alone"):
        carry_out(FakeBus(), Fault("kill", "plant"), {"plant": os.getpid()})


def test_a_service_that_does_not_answer_gets_no_fault(bus):
    with pytest.raises(CellError, match="plant does not answer"):
        inject_now(bus, Fault("kill", "plant"))
    with pytest.raises(CellError, match="plant does not answer"):
        ProcessFaults(bus, (Fault("freeze", "plant"),), 1.0)


def test_what_is_killed_is_gone(bus, process):
    inject_now(bus, Fault("kill", "controller"))
    assert process.wait(10.0) == -signal.SIGKILL


@pytest.mark.parametrize("fault", [Fault("freeze", "controller"), Fault("hog", "host", value=1.0)])
def test_what_this_command_must_undo_needs_an_end(bus, fault):
    with pytest.raises(RefusedError, match="--for"):
        inject_now(bus, fault)


def test_a_trial_freezes_at_its_time_and_thaws_at_its_end(bus, process):
    faults = ProcessFaults(bus, (Fault("freeze", "controller", at_s=0.5),), 2.0)
    faults.at(0.499)
    assert until_state(process, "SR") in "SR" and faults.pending
    faults.at(0.501)
    assert until_state(process, "T") == "T"
    faults.end()
    assert until_state(process, "SR") in "SR" and not faults.pending
    assert faults.done == ["freeze controller: at 0.501 s", "freeze controller: ended after the trial"]


def test_a_freeze_ends_by_the_wall_clock_while_the_trial_stands_still(bus, process):
    faults = ProcessFaults(bus, (Fault("freeze", "controller", lasts_s=0.05),), 2.0)
    faults.at(0.0)
    time.sleep(0.06)
    faults.at(0.0)
    assert not faults.pending and until_state(process, "SR") in "SR"


def test_what_never_came_to_pass_is_said(bus):
    faults = ProcessFaults(bus, (Fault("kill", "controller", at_s=9.0),), 10.0)
    faults.end()
    assert faults.done == ["kill controller: never, the trial ended before"]


def test_a_hog_runs_as_long_as_it_is_asked_to(bus):
    undo = carry_out(bus, Fault("hog", "host", value=2.0), {})
    assert until(lambda: busy() == 2)
    undo()
    assert busy() == 0
