"""Parameters changed in real cells: by hand with `hydrohil set`, and scheduled, where the clocks agree to the bit."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from hydrohil.claims.trace import Trace
from hydrohil.claims.trace_files import read_trace
from hydrohil.experiment.experiment import to_toml
from hydrohil.services.controller.config import ScheduledChange
from tests.support.live_cell import Cell, end, experiment, hydrohil, own_place, until

pytestmark = pytest.mark.live
WALL_CLOCK = {"sample_age_s"}
LASTS_S = 15.0  # a command takes seconds to start on a busy machine
GAIN = "controller.gains.down_up.kp_a_per_rad"


@pytest.fixture(scope="module")
def cell() -> Iterator[Cell]:
    live = Cell()
    yield live
    live.close()


def test_a_gain_and_a_law_are_changed_in_a_trial_which_then_has_no_verdict(cell: Cell, tmp_path: Path):
    report, rrd = tmp_path / "r.json", tmp_path / "r.rrd"
    run = cell.begun_run(tmp_path, "--json", str(report), "--rrd", str(rrd), duration_s=LASTS_S)
    done = cell.run("set", f"{GAIN}=6.0", "controller.law=pi", "--json")
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    assert [(one["path"], one["new"]) for one in answer["changed"]] == [("controller.law", '"pi"'), (GAIN, "6.0")]
    assert "changed: controller.law" in " ".join(cell.run("status").stdout.split())
    out, err = run.communicate(timeout=60)
    assert run.returncode == 5, out + err
    assert "NO VERDICT" in out and f'changed by hand at sample {answer["number"]}: controller.law "final" -> "pi"' in out
    written = json.loads(report.read_text())
    assert written["exit_status"] == 5 and len(written["changed_by_hand"]) == 2
    assert written["gap"] or written["claims"][0]["measured"] is not None  # a busy machine may lose a tick of so long a trial
    assert cell.status("controller")["changed"] == [] and cell.status("controller")["law"] == "final"
    log = "".join(
        str(chunk.to_record_batch().to_pydict()) for chunk in RrdReader(rrd).stream() if "log/controller" in chunk.entity_path
    )
    assert "changed by hand" in log and GAIN in log


@pytest.mark.parametrize(
    ("assignments", "words"),
    [
        ((f"{GAIN}=-1",), "greater than or equal to 0"),
        (("controller.lav=pi",), "use one of law"),
        (("controller.law=pi", "controller.slew_codes=2000"), "stays while a trial runs"),
        (("supervisor.force_limit_n=100",), "only [controller] may change"),
        (("controller.impedance.mass_kg=3",), "has no target impedance"),
    ],
)
def test_what_may_not_be_is_refused_in_one_line_and_the_trial_goes_on(
    cell: Cell, tmp_path: Path, assignments: tuple[str, ...], words: str
):
    run = cell.begun_run(tmp_path, duration_s=4.0 * LASTS_S)
    refused = cell.run("set", *assignments)
    assert refused.returncode == 2
    (line,) = refused.stderr.strip().splitlines()
    assert words in line
    assert cell.moves() and cell.status("controller")["changed"] == []
    assert end(run)[0] == 130
    until(cell.at_rest, "the valves are at zero")


def test_without_a_trial_it_is_refused_and_without_a_cell_it_says_so(cell: Cell):
    refused = cell.run("set", "controller.law=pi")
    assert refused.returncode == 2 and "hydrohil run NAME" in refused.stderr
    alone = hydrohil(own_place(), "set", "controller.law=pi")
    assert alone.returncode == 5 and "does not answer" in alone.stderr


def test_scheduled_changes_act_at_the_same_tick_in_lockstep_and_on_the_local_clock(cell: Cell, tmp_path: Path):
    changes = (ScheduledChange(0.45, (f"{GAIN}=6.0", "controller.law=vetia")), ScheduledChange(0.9, ("controller.law=pi",)))
    file, traces = tmp_path / "scheduled.toml", []
    file.write_text(to_toml(experiment(1.5)._replace(changes=changes)))
    for clock in ("lockstep", "local"):
        trace = tmp_path / f"{clock}.npz"
        run = cell.run("run", str(file), "--clock", clock, "--seed", "7", "--trace", str(trace))
        assert run.returncode == 0, run.stdout + run.stderr
        traces.append(read_trace(trace))
    for field in set(Trace._fields) - WALL_CLOCK:
        there, here = (getattr(trace, field) for trace in traces)
        assert there.dtype == here.dtype and np.array_equal(there.view(np.int64), here.view(np.int64)), field
    tick = traces[0].tick.tolist().index(100)
    assert (abs(traces[0].dac_counts[tick] - traces[0].dac_counts[tick - 1]) <= 1).all()
