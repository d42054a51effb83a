"""A cell around a router: it arms and runs; a router that dies leaves the valves at zero, and its return resumes nothing."""

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from hydrohil.cell import processes as cells
from hydrohil.shared.host.child import environment, python_module
from hydrohil.shared.transport.endpoints import Network
from tests.support.live_cell import LEASE, LEASE_MS, ZERO, begun, ended, hydrohil, own_place, processes, swing, until

pytestmark = pytest.mark.live


class Router:
    """A router's process, killed and started again."""

    def __init__(self, port: int) -> None:
        self.endpoint = f"tcp/127.0.0.1:{port}"
        self.start()

    def start(self) -> None:
        line = [*python_module("hydrohil.services.router"), "--listen", self.endpoint, "--with-parent", str(os.getpid())]
        self.process = subprocess.Popen(line, env=environment(), stdout=subprocess.PIPE)
        assert self.process.stdout.readline().startswith(b"router: listens")

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()


@pytest.fixture
def router() -> Iterator[Router]:
    started = Router(own_place().port)
    yield started
    started.kill()


def place_behind(router: Router) -> cells.Place:
    return own_place()._replace(network=Network(router=router.endpoint))


def status(place: cells.Place, service: str) -> dict:
    with cells.operator_bus(place) as bus:
        return cells.statuses(bus, (service,)).get(service, {})


def test_a_routed_cell_comes_up_runs_is_broken_stops_and_goes_down_by_commands_alone(router: Router, tmp_path: Path):
    place = place_behind(router)
    up = hydrohil(place, "up", "--permit-ttl-ms", LEASE_MS)
    assert up.returncode == 0, up.stdout + up.stderr
    try:
        assert hydrohil(place, "status").returncode == 0
        run = hydrohil(place, "run", swing(tmp_path))
        assert run.returncode == 0, run.stdout + run.stderr
        assert hydrohil(place, "inject", "dropout", "force", "--for", "0.1").returncode == 0
        second = hydrohil(place, "controller")
        (line,) = second.stderr.strip().splitlines()
        assert second.returncode == 5 and "at this router already" in line and place.cell in line
        assert hydrohil(place, "estop").returncode == 0
    finally:
        assert hydrohil(place, "down").returncode == 0
    assert not processes(place)


def test_a_dead_router_is_a_safe_plant_no_confirmed_stop_and_its_return_resumes_nothing(router: Router, tmp_path: Path):
    place = place_behind(router)
    started = cells.start(place, cells.LOOP, with_parent=True, extra=LEASE)
    try:
        with cells.operator_bus(place) as bus:
            cells.await_ready(place, bus, started)
        run = begun(place, "run", swing(tmp_path, 60.0))
        until(lambda: status(place, "plant").get("dac_counts", ZERO) != ZERO, "the valves move")
        router.kill()
        stopped = hydrohil(place, "estop")
        assert stopped.returncode == 5 and "NOT CONFIRMED" in stopped.stderr, stopped.stdout + stopped.stderr
        router.start()
        until(lambda: status(place, "supervisor").get("mode") == "TRIPPED", "the supervisor answers again, and has tripped")
        plant = until(lambda: status(place, "plant"), "the plant answers again")
        assert plant["dac_counts"] == ZERO and plant["revoked_arming_ids"] == 1
        assert plant["last_cut"] in ("PERMIT_STALE", "COMMAND_STALE")
        code, words = ended(run)
        assert code in (3, 5), words
        assert hydrohil(place, "reset").returncode == 0
        assert status(place, "plant")["dac_counts"] == ZERO
    finally:
        cells.stop(process.pid for process in started.values())


def test_services_wait_for_a_router_that_comes_last(tmp_path: Path):
    late = own_place()
    place = late._replace(network=Network(router=f"tcp/127.0.0.1:{late.port}"))
    started = cells.start(place, cells.LOOP, with_parent=True, extra=LEASE)
    router = None
    try:
        until(lambda: "waits for the router" in cells.last_words(place, "supervisor"), "the supervisor waits")
        router = Router(late.port)
        until(lambda: hydrohil(place, "status").returncode == 0, "the cell is whole")
    finally:
        cells.stop(process.pid for process in started.values())
        if router is not None:
            router.kill()
