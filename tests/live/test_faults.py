"""A machine that is broken on purpose in a real cell: the clocks agree to the bit, and so do announced and real begin."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from hydrohil.claims.trace import Trace
from hydrohil.claims.trace_files import read_trace
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import FaultEvent
from hydrohil.shared.machine.unimate import UNIMATE
from tests.support.live_cell import Cell, swing, until

pytestmark = pytest.mark.live
WALL_CLOCK = {"sample_age_s"}
SENSORS = (  # none of them for so long, or so far, that a rule trips
    "stuck force at=0.1 for=0.08",
    "offset force value=30 at=0.3 for=0.2",
    "drift force value=80 at=0.5 for=0.3",
    "gain force value=0.5 at=0.8 for=0.2",
    "noise force value=3 at=1.0",
    "offset encoder_out_in value=2 at=0.2 for=0.3",
    "noise encoder_rotate value=2 at=0.4 for=0.4",
    "drift encoder_down_up value=20 at=0.7 for=0.3",
    "stuck encoder_out_in at=0.9 for=0.3",
)
ACTUATORS = (
    "stuck dac_rotate at=0.1 for=0.2",
    "leak valve_down_up value=10 at=0.2 for=0.4",
    "drop supply value=0.4 at=0.5 for=0.5",
    "stuck valve_out_in at=0.6 for=0.3",
    "stuck dac_down_up at=1.1 for=0.02",
    "stuck valve_down_up at=1.2 for=0.05",
)


@pytest.fixture(scope="module")
def cell() -> Iterator[Cell]:
    live = Cell()
    yield live
    live.close()


def options(faults: tuple[str, ...]) -> list[str]:
    return [word for fault in faults for word in ("--inject", fault)]


def trace(cell: Cell, folder: Path, clock: str, faults: tuple[str, ...], status: int, *more: str) -> Trace:
    """The trace of one run that ends with `status`."""
    file = folder / f"{clock}.npz"
    run = cell.run("run", swing(folder), "--clock", clock, "--seed", "7", "--trace", str(file), *options(faults), *more)
    assert run.returncode == status, run.stdout + run.stderr
    return read_trace(file)


def assert_same_bits(there: Trace, here: Trace) -> None:
    for field in set(Trace._fields) - WALL_CLOCK:
        first, second = getattr(there, field), getattr(here, field)
        assert first.dtype == second.dtype and np.array_equal(first.view(np.int64), second.view(np.int64)), field


@pytest.mark.parametrize("faults", [SENSORS, ACTUATORS], ids=["sensors", "actuators"])
def test_lockstep_equals_local_bit_for_bit_with_a_broken_machine(cell: Cell, tmp_path: Path, faults: tuple[str, ...]):
    local = trace(cell, tmp_path, "local", faults, 0)
    assert_same_bits(trace(cell, tmp_path, "lockstep", faults, 0), local)
    sound = trace(cell, tmp_path, "local", (), 0)
    assert not np.array_equal(local.dac_counts, sound.dac_counts)


def test_a_dead_gauge_trips_lockstep_and_local_at_the_same_tick_and_the_recording_says_so(cell: Cell, tmp_path: Path):
    dead, rrd = ("dropout force at=0.9",), tmp_path / "r.rrd"
    local = trace(cell, tmp_path, "local", dead, 3)
    assert local.tick[-1] == 200 and local.force_counts[-1] == UNIMATE.force.low
    assert_same_bits(trace(cell, tmp_path, "lockstep", dead, 3, "--rrd", str(rrd)), local)
    log = "".join(
        str(chunk.to_record_batch().to_pydict()) for chunk in RrdReader(rrd).stream() if "log/plant" in chunk.entity_path
    )
    assert "fault begins: dropout force" in log and "fault ends: dropout force" in log
    cell.calm()


def test_what_is_injected_begins_at_the_sample_that_is_announced_is_shown_and_ends_when_cleared(cell: Cell):
    samples, events = cell.bus.subscribe("plant/sample", 4096), cell.bus.subscribe("plant/fault")
    done = cell.run("inject", "dropout", "force", "--after", "0.1", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["fault"]["kind"] == "dropout"
    begins = int(json.loads(done.stdout)["done"].rsplit(" ", 1)[1])
    until(lambda: cell.status("plant")["faults"]["acting"], "the fault acts")
    assert "fault acting: dropout force" in cell.run("status").stdout
    assert cell.run("inject", "--clear").returncode == 0
    until(lambda: isinstance(events.peek(), Received) and events.peek().body.acting == 0, "the fault ends")
    first, last = (message.body for message in events.take())
    assert first == FaultEvent(begins, first.tick, 1, "dropout", "force", 0.0)
    assert cell.status("plant")["faults"] == {"acting": [], "waiting": []}
    observed = {message.body.number: message.body.force_counts for message in samples.take()}
    assert min(observed) < begins
    for number, counts in observed.items():
        assert (counts == UNIMATE.force.low) == (begins <= number < last.number)


def test_what_is_injected_into_a_trial_breaks_it(cell: Cell, tmp_path: Path):
    run = cell.begun_run(tmp_path)
    assert cell.run("inject", "dropout", "force", "--for", "0.5").returncode == 0
    out, err = run.communicate(timeout=60)
    assert run.returncode == 3, out + err
    assert "force reading" in out + err
    cell.calm()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("stuck", "valve_pitch"), "expected one of"),
        (("offset", "force", "--value", "1001"), "expected -1000..1000"),
        (("stuck",), "--list"),
        (("--list", "--clear"), "--list"),
    ],
)
def test_what_cannot_be_injected_is_refused_in_one_line(cell: Cell, arguments: tuple[str, ...], words: str):
    refused = cell.run("inject", *arguments)
    assert refused.returncode == 2
    (line,) = refused.stderr.strip().splitlines()
    assert words in line
