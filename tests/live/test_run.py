"""Runs in a real cell: the command line end to end, the clocks, the recording, foreign frames on the network."""

import json
import signal
import socket
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from hydrohil.cell import processes as cells
from hydrohil.claims.trace import Trace
from hydrohil.claims.trace_files import read_trace
from hydrohil.shared.contract.codec import MAX_FRAME_BYTES, WIRE_VERSION, Header, encode
from hydrohil.shared.contract.messages import NO_COMMAND, Command
from hydrohil.shared.contract.topics import expression
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.endpoints import Network
from tests.support.live_cell import ZERO, Cell, begun, end, ended, hydrohil, own_place, processes, swing, until

pytestmark = pytest.mark.live
WALL_CLOCK = {"sample_age_s"}
COMMAND = "controller/command"


@pytest.fixture(scope="module")
def cell() -> Iterator[Cell]:
    live = Cell()
    yield live
    live.close()


def readable(path: Path) -> bool:
    """Whether a recording opens and holds rows of the plant."""
    return "figure" in "".join(str(chunk.entity_path) for chunk in RrdReader(path).stream())


def test_a_real_run_ends_with_its_verdict_report_trace_and_recording(cell: Cell, tmp_path: Path):
    file, trace, rrd = tmp_path / "r.json", tmp_path / "t.npz", tmp_path / "r.rrd"
    run = cell.run("run", swing(tmp_path), "--json", str(file), "--trace", str(trace), "--rrd", str(rrd))
    assert run.returncode == 0, run.stdout + run.stderr
    report = json.loads(file.read_text())
    assert (report["clock"], report["exit_status"], report["tripped"], report["gap"]) == ("real", 0, None, None)
    assert [claim["holds"] for claim in report["claims"]] == [True]
    observed = read_trace(trace)
    assert list(observed.tick) == list(range(round(1.5 / 4.5e-3)))
    assert {len(column) for column in observed} == {len(observed.tick)}
    assert readable(rrd)


def test_a_longer_tool_runs_on_every_clock_because_everybody_takes_the_machine_from_the_plant(cell: Cell, tmp_path: Path):
    traces = {}
    for clock in ("local", "lockstep", "real"):
        file = tmp_path / f"{clock}.npz"
        longer = ("--set", "plant.machine.a4_m=0.7")
        run = cell.run("run", swing(tmp_path), *longer, "--clock", clock, "--seed", "3", "--trace", str(file))
        assert run.returncode == 0, run.stdout + run.stderr
        traces[clock] = read_trace(file)
    assert traces["local"].x_m[0][2] == pytest.approx(0.13 - 0.7, abs=0.01)
    assert (traces["lockstep"].x_m == traces["local"].x_m).all()
    assert traces["real"].x_m[0] == pytest.approx(traces["local"].x_m[0], abs=1e-9)


def test_lockstep_equals_local_bit_for_bit(cell: Cell, tmp_path: Path):
    traces = []
    for clock in ("lockstep", "local"):
        file = tmp_path / f"{clock}.npz"
        run = cell.run("run", swing(tmp_path, 4.0), "--clock", clock, "--seed", "7", "--trace", str(file))
        assert run.returncode == 0, run.stdout + run.stderr
        traces.append(read_trace(file))
    for field in set(Trace._fields) - WALL_CLOCK:
        there, here = (getattr(trace, field) for trace in traces)
        assert there.dtype == here.dtype and np.array_equal(there.view(np.int64), here.view(np.int64)), field


def test_a_second_controller_is_refused_in_one_line(cell: Cell):
    second = hydrohil(cell.place, "controller")
    assert second.returncode == 5
    (line,) = second.stderr.strip().splitlines()
    assert f"port {cell.place.port + 1}" in line and "hydrohil down" in line and "--port" in line


def frames(cell: str) -> dict[str, bytes]:
    """Frames of a foreign sender, by the cause under which each must be counted."""
    key = expression(cell, COMMAND)

    def frame(**changed: object) -> bytes:
        header = Header(
            version=WIRE_VERSION,
            schema=5,
            cell=cell,
            run=0,
            experiment=b"",
            sender="controller",
            epoch=1,
            arming_id=0,
            seq=0,
            echo_number=NO_COMMAND,
            echo_time_ns=0,
        )
        return encode(key, header._replace(**changed), Command((820, 820, 820)))

    whole = frame()
    return {
        "oversized": bytes(MAX_FRAME_BYTES + 1),
        "crc": bytes(range(200)),
        "malformed": b"",
        "version": frame(version=WIRE_VERSION + 1),
        "cell": frame(cell="another"),
        "sender": frame(sender="stranger"),
        "schema": frame(schema=25),
    } | {"crc": whole[:-1] + bytes([whole[-1] ^ 1])}


def test_foreign_frames_are_counted_by_cause_and_change_nothing(cell: Cell, tmp_path: Path):
    before = cell.status("plant")["link_stats"][COMMAND]
    run = cell.begun_run(tmp_path, duration_s=4.0)
    sent = 0
    with Bus("stranger", cell.place.cell, cell.place.port, 1) as bus:
        until(lambda: "plant" in bus.alive(0.2), "the foreign sender sees the plant")
        key = expression(cell.place.cell, COMMAND)
        for _ in range(20):
            for frame in frames(cell.place.cell).values():
                bus._session.put(key, frame)
            sent += 1
            time.sleep(0.02)  # within what the plant's ring holds between two of its steps
        until(lambda: all(_counted(cell, before, cause) == sent for cause in frames(cell.place.cell)), "every frame is counted")
    status, words = ended(run)
    assert status == 0, words


def _counted(cell: Cell, before: dict[str, int], cause: str) -> int:
    return int(cell.status("plant")["link_stats"][COMMAND].get(cause, 0)) - before.get(cause, 0)


def test_an_interrupted_run_leaves_the_cell_disarmed_with_its_valves_at_zero(cell: Cell, tmp_path: Path):
    status, words = end(cell.begun_run(tmp_path))
    assert status == 130 and "interrupted" in words
    assert cell.status("plant")["dac_counts"] == ZERO
    assert cell.status("supervisor")["mode"] == "DISARMED"


def test_a_killed_recorder_is_said_and_changes_nothing(cell: Cell, tmp_path: Path):
    run = cell.begun_run(tmp_path, "--rrd", str(tmp_path / "r.rrd"), duration_s=4.0)
    cell.kill("recorder")
    status, words = ended(run)
    assert status == 0, words
    assert "recorder" in words and "lost" in words


def test_a_run_that_is_killed_leaves_no_process(tmp_path: Path):
    place = own_place()
    run = begun(place, "run", swing(tmp_path, 20.0), "--permit-ttl-ms", "200")
    try:
        until(lambda: len(processes(place)) == 4, "four services")
    finally:
        end(run, signal.SIGKILL)
    until(lambda: not processes(place), "no service is left")


def test_an_interrupted_run_leaves_no_process_and_a_readable_recording(tmp_path: Path):
    place, rrd = own_place(), tmp_path / "r.rrd"
    run = begun(place, "run", swing(tmp_path, 20.0), "--permit-ttl-ms", "200", "--rrd", str(rrd))
    try:
        with cells.operator_bus(place) as bus:
            until(lambda: cells.statuses(bus, ("plant",)).get("plant", {}).get("tick"), "a trial runs")
    finally:
        status, words = end(run)
    assert status == 130, words
    assert not processes(place)
    assert readable(rrd)


def test_a_port_in_use_is_named_and_nothing_is_left(tmp_path: Path):
    place = own_place()
    with socket.socket() as other:
        other.bind(("127.0.0.1", place.port + 2))
        other.listen()
        run = hydrohil(place, "run", swing(tmp_path), "--permit-ttl-ms", "200")
    assert run.returncode == 5
    assert f"port {place.port + 2}" in run.stderr and "--port" in run.stderr
    assert not processes(place)


def test_a_cell_whose_services_have_addresses_of_their_own_comes_up_runs_and_goes_down(tmp_path: Path):
    place = own_place()._replace(network=Network((("plant", "127.0.0.2"), ("controller", "127.0.0.3"))))
    up = hydrohil(place, "up", "--permit-ttl-ms", "200")
    try:
        assert up.returncode == 0, up.stdout + up.stderr
        run = hydrohil(place, "run", swing(tmp_path))
        assert run.returncode == 0, run.stdout + run.stderr
        second = hydrohil(place, "plant")
        assert second.returncode == 5 and f"port {place.port} on 127.0.0.2 is in use" in second.stderr, second.stderr
    finally:
        assert hydrohil(place, "down").returncode == 0
    assert not processes(place)


def test_up_starts_what_is_here_says_how_the_rest_is_started_and_run_brings_up_no_cell_that_needs_another_host(tmp_path: Path):
    place = own_place()._replace(network=Network((("plant", "192.0.2.7"),)))  # kept for examples: no machine has it
    run = hydrohil(place, "run", swing(tmp_path))
    assert run.returncode == 5 and "start each on its host" in run.stderr, run.stderr
    up = begun(place, "up")
    assert up.stdout is not None
    line = up.stdout.readline()
    assert line == f"on 192.0.2.7: hydrohil plant --cell {place.cell} --port {place.port} --hosts plant=192.0.2.7\n"
    until(lambda: len(processes(place)) == 3, "the others are started")
    status, words = end(up)
    assert status == 5 and "interrupted" in words
    assert not processes(place)
