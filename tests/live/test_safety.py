"""A real cell that loses a service, or is stopped, in the middle of a trial."""

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.live_cell import Cell, ended, hydrohil, own_place, swing, until

pytestmark = pytest.mark.live


@pytest.fixture(scope="module")
def cell() -> Iterator[Cell]:
    live = Cell()
    yield live
    live.close()


@pytest.fixture(autouse=True)
def cell_is_calm_afterwards(cell: Cell) -> Iterator[None]:
    yield
    for service, process in cell.processes.items():
        if process.poll() is not None:
            cell.revive(service)
    cell.calm()


def test_an_emergency_stop_is_confirmed_latched_and_reset(cell: Cell, tmp_path: Path):
    run = cell.begun_run(tmp_path)
    stop = cell.run("estop")
    assert stop.returncode == 0 and "zero current" in stop.stdout
    assert cell.at_rest()
    status, words = ended(run)
    assert status == 3 and "emergency stop" in words
    again = cell.run("run", swing(tmp_path))
    assert again.returncode == 3 and "hydrohil reset" in again.stderr
    assert cell.run("status").returncode == 3
    assert cell.run("reset").returncode == 0
    assert cell.run("status").returncode == 0


def test_an_emergency_stop_without_a_plant_is_not_confirmed():
    stop = hydrohil(own_place(), "estop")
    assert stop.returncode == 5
    assert "NOT CONFIRMED" in stop.stderr


def test_a_killed_controller_is_named_and_the_valves_are_at_zero(cell: Cell, tmp_path: Path):
    run = cell.begun_run(tmp_path)
    cell.kill("controller")
    status, words = ended(run)
    assert status in (3, 5) and "controller" in words, words
    assert cell.at_rest()
    missing = cell.run("run", swing(tmp_path))
    assert missing.returncode == 5
    assert "no controller" in missing.stderr and "hydrohil controller" in missing.stderr


def test_a_killed_supervisor_is_named_and_the_valves_are_at_zero(cell: Cell, tmp_path: Path):
    run = cell.begun_run(tmp_path)
    cell.kill("supervisor")
    until(cell.at_rest, "valves at zero")
    status, words = ended(run)
    assert status == 5 and "supervisor" in words, words


def test_a_reset_is_refused_while_the_plant_is_gone(cell: Cell, tmp_path: Path):
    run = cell.begun_run(tmp_path)
    cell.kill("plant")
    status, words = ended(run)
    assert status in (3, 5) and "plant" in words, words
    reset = cell.run("reset")
    assert reset.returncode == 5 and "the plant does not answer" in reset.stderr
    asked = cell.bus.ask("supervisor", "reset", {}, 5.0)
    assert asked is not None and not asked.accepted
    assert "no sample came for" in asked.reason
    assert cell.status("supervisor")["mode"] == "TRIPPED"


def test_a_controller_that_returns_moves_nothing(cell: Cell, tmp_path: Path):
    run = cell.begun_run(tmp_path)
    cell.processes["controller"].send_signal(signal.SIGSTOP)
    try:
        until(cell.at_rest, "valves at zero")
        status, _ = ended(run)
    finally:
        cell.processes["controller"].send_signal(signal.SIGCONT)
    assert status in (3, 5)
    for _ in range(50):
        assert cell.at_rest()


@pytest.mark.parametrize("service", ["recorder", "controller", "supervisor", "plant"])
def test_a_service_ends_on_sigterm_with_status_0(cell: Cell, service: str):
    process = cell.processes[service]
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=5.0) == 0
