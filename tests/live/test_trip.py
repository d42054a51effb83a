"""A trip in a real lockstep cell: the report has the tick, the rule and the numbers that the local clock has."""

import json
from pathlib import Path

import pytest

from hydrohil.services.supervisor.config import JointHighLimits
from hydrohil.shared.contract.messages import Mode
from hydrohil.shared.trips.files import read, reports
from hydrohil.simulation.rollout import play_local
from hydrohil.simulation.trip_local import local_report
from hydrohil.thesis.library import load
from tests.support.live_cell import Cell, ended, swing, until

pytestmark = pytest.mark.live
LIMIT = "supervisor.joint_high_q.down_up=0.05"  # the swing goes to 0.09 rad


@pytest.fixture
def cell(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # where the recorder and the command write
    live = Cell()
    yield live
    live.close()


def tripped(cell: Cell, folder: Path) -> dict:
    """The report of one tripping run, as `--json` writes it."""
    run = cell.run("run", swing(folder), "--clock", "lockstep", "--set", LIMIT, "--json", str(folder / "r.json"))
    assert run.returncode == 3, run.stdout + run.stderr
    report = json.loads((folder / "r.json").read_text())
    assert report["trip"]["sentence"] in run.stdout.replace("\n", "")
    return report


def unloaded(cell: Cell) -> None:
    """Moved back inside the limit, then reset: a reset alone is refused while the cause stands."""
    until(lambda: cell.run("recover", "--seconds", "1.5") and cell.run("reset").returncode == 0, "reset is accepted")


def test_a_trip_in_lockstep_is_reported_exactly_twice_if_it_happens_twice_and_without_a_recorder_too(cell: Cell, tmp_path: Path):
    report = tripped(cell, tmp_path)
    experiment = load(Path(swing(tmp_path)))
    tight = experiment.supervisor._replace(joint_high_q=JointHighLimits(1.0, 0.05, 1.0))
    outcome = play_local(experiment._replace(supervisor=tight), 0)
    assert outcome.supervisor.mode == Mode.TRIPPED
    local = local_report(experiment, outcome)
    assert local is not None
    for field in ("by", "cause", "measured", "limit", "tick", "trial_time_s"):
        assert report["trip"][field] == local[field], report["trip"]["sentence"]
    assert report["trip"]["stop"]["samples_later"] == 1
    assert report["trip"]["stop"]["tip_moved_m"] > 0.0
    (file,) = reports(tmp_path / "runs" / "trips")
    assert Path(report["trip_report"]) == file
    written = read(file)
    assert (written["sample"], written["receiver"]) == (report["trip"]["sample"], "the recorder's")
    assert written["signals"]["plant/sample"]["tick"].count(local["tick"]) == 1
    assert str(file) in cell.run("status").stdout.replace("\n", "").replace("│", "").replace(" ", "")

    unloaded(cell)
    second = tripped(cell, tmp_path)
    assert len(reports(tmp_path / "runs" / "trips")) == 2
    assert second["trip"]["sample"] > report["trip"]["sample"] and second["trip"]["tick"] == report["trip"]["tick"]

    cell.kill("recorder")
    unloaded(cell)
    alone = tripped(cell, tmp_path)
    assert alone["trip"]["receiver"] == "this command's"
    assert read(Path(alone["trip_report"]))["sample"] == alone["trip"]["sample"]
    assert len(reports(tmp_path / "runs" / "trips")) == 3


def test_a_killed_supervisor_leaves_the_report_of_the_gate_s_cut(cell: Cell, tmp_path: Path):
    run = cell.begun_run(tmp_path)
    cell.kill("supervisor")
    until(cell.at_rest, "valves at zero")
    status, words = ended(run)
    assert status == 5 and "The gate cut by itself: the permit was" in words, words
    (file,) = until(lambda: reports(tmp_path / "runs" / "trips"), "the recorder's report")
    document = read(file)
    assert (document["by"], document["cause"]) == ("gate", "PERMIT_STALE")
    assert document["measured"] > document["limit"]
