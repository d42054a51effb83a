"""Processes of a cell: none is left when `stop` returns."""

import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from hydrohil.cell import processes as cells
from hydrohil.cli.main import app
from hydrohil.shared.contract.topics import SERVICES
from hydrohil.shared.transport.endpoints import Network

FAR = "192.0.2.7"  # of the network kept for examples: no machine has it
COMMANDS = (("up",), ("down",), ("status",), ("estop",), ("stop",), ("reset",), ("recover",), ("inject", "stuck", "force"))

DEAF = "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); print(flush=True); time.sleep(60)"
MILD = "import time; print(flush=True); time.sleep(60)"


def started(program: str) -> subprocess.Popen[bytes]:
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.readline()
    return process


def test_stop_ends_the_deaf_too_and_returns_when_all_are_gone(monkeypatch):
    monkeypatch.setattr(cells, "_STOP_S", 0.2)
    processes = [started(MILD), started(DEAF)]
    cells.stop(process.pid for process in processes)
    for process in processes:
        stat = Path(f"/proc/{process.pid}/stat")
        assert not stat.exists() or stat.read_text().rsplit(")", 1)[1].split()[0] == "Z"


def test_a_process_that_is_gone_already_is_no_trouble():
    process = started(MILD)
    process.kill()
    process.wait()
    cells.stop([process.pid])


def test_a_place_says_itself_in_the_options_that_services_and_commands_know():
    place = cells.Place("left", 7550, Network((("plant", FAR),)))
    assert place.words == ["--cell", "left", "--port", "7550", "--hosts", f"plant={FAR}"]
    assert cells.Place("left", 7550).words == ["--cell", "left", "--port", "7550"]


def test_what_runs_elsewhere_is_known_by_its_address_and_behind_a_router_nobody_has_one():
    spread = Network((("plant", FAR), ("controller", "127.0.0.1")))
    assert cells.Place("c", 7450, spread).elsewhere(SERVICES) == ["plant"]
    assert cells.Place("c", 7450).elsewhere(SERVICES) == []
    assert cells.Place("c", 7450, Network(router=f"tcp/{FAR}:7447")).elsewhere(SERVICES) == []


@pytest.mark.parametrize("command", [*COMMANDS, ("run", "fig-4-25")], ids=lambda words: words[0])
@pytest.mark.parametrize("where", [("--hosts", "plan=10.0.0.5"), ("--router", "10.0.0.9")], ids=lambda words: words[0])
def test_a_command_refuses_hosts_and_routers_that_say_nothing_in_one_line(command, where):
    refused = CliRunner().invoke(app, [*command, *where])
    assert refused.exit_code == 2
    (line,) = refused.stderr.strip().splitlines()
    assert line.startswith(where[0])


def test_up_starts_nothing_where_every_service_is_elsewhere(tmp_path, monkeypatch):
    monkeypatch.setenv("HYDROHIL_CACHE", str(tmp_path))
    monkeypatch.setattr(cells, "start", lambda *_, **__: pytest.fail("started"))
    refused = CliRunner().invoke(app, ["up", "--hosts", ",".join(f"{service}={FAR}" for service in SERVICES)])
    assert refused.exit_code == 2
    assert "each on its host" in refused.stderr


def test_a_router_that_is_not_there_confirms_no_emergency_stop():
    asked = CliRunner().invoke(app, ["estop", "--router", "tcp/127.0.0.1:1"])
    assert asked.exit_code == 5
    (line,) = asked.stderr.strip().splitlines()
    assert "NOT CONFIRMED" in line and "tcp/127.0.0.1:1" in line and "hydrohil router" in line
