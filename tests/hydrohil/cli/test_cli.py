"""The command line without a cell: what it lists, runs on the local clock, writes and refuses."""

import json
import os
import tomllib
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from hydrohil.cell.cell import Cell
from hydrohil.claims.trace import Trace
from hydrohil.claims.trace_files import read_trace
from hydrohil.cli.main import app
from hydrohil.cli.options import make_folders
from hydrohil.experiment.experiment import to_plain, warnings
from hydrohil.reproduction.studies import STUDIES
from hydrohil.shared.contract.messages import Mode
from hydrohil.thesis.library import catalogue, find, load

EXPERIMENT = "fig-4-25"
LOCAL = ("--clock", "local")
IMPOSSIBLE = "claims.0.high=1e-6"  # no sine is followed to a millionth


def hydrohil(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments))


def test_list_keeps_what_has_every_word():
    names = [entry["name"] for entry in json.loads(hydrohil("list", "static", "PLATE", "--json").stdout)]
    assert "fig-5-5" in names and "fig-4-25" not in names
    run = hydrohil("list", "no-such-thing")
    assert run.exit_code == 2 and "no-such-thing" in run.stderr


def test_show_prints_json_and_its_schema():
    assert json.loads(hydrohil("show", EXPERIMENT, "--json").stdout) == to_plain(find(EXPERIMENT))
    assert json.loads(hydrohil("show", EXPERIMENT, "--schema").stdout)["properties"]["duration_s"]["unit"] == "s"
    assert hydrohil("show", EXPERIMENT, "--json", "--toml").exit_code == 2


def test_a_file_in_a_missing_folder_elsewhere_is_refused_and_one_in_the_working_folder_makes_it(tmp_path, monkeypatch):
    work = tmp_path / "work"
    work.mkdir()
    monkeypatch.chdir(work)
    run = hydrohil("run", EXPERIMENT, "--clock", "local", "--json", str(tmp_path / "mistyped" / "report.json"))
    assert run.exit_code == 2 and "does not exist" in run.stderr and not (tmp_path / "mistyped").exists()
    make_folders(Path("new") / "here" / "report.json")
    assert (work / "new" / "here").is_dir()


def test_a_gain_in_the_units_of_the_thesis_is_warned_of_with_both_numbers():
    run = hydrohil("show", EXPERIMENT, "--set", "controller.gains.down_up.kp_a_per_rad=215")
    assert "controller.gains.down_up.kp_a_per_rad is 215, its default 12.3" in run.stdout


def test_no_experiment_that_ships_is_warned_of_for_its_values():
    assert not [e.name for e in catalogue() for line in warnings(e) if "its default" in line]


def test_list_names_every_experiment():
    listed = json.loads(hydrohil("list", "--json").stdout)
    trials = [entry["name"] for entry in listed if not entry.get("computed")]
    assert sorted(trials) == sorted(experiment.name for experiment in catalogue())
    assert {entry["name"] for entry in listed if entry.get("computed")} == {study.name for study in STUDIES}
    assert all(name in hydrohil("list").stdout for name in ("fig-4-2", "fig-5-14"))


def test_show_states_every_claim_with_its_band_and_source():
    shown = hydrohil("show", EXPERIMENT)
    assert shown.exit_code == 0
    for claim in find(EXPERIMENT).claims:
        assert claim.statement in shown.stdout.replace("\n", " ")


def test_an_alias_shows_the_same_experiment():
    assert hydrohil("show", find(EXPERIMENT).alias).stdout == hydrohil("show", EXPERIMENT).stdout


def test_a_second_figure_of_a_trial_shows_that_trial():
    assert hydrohil("show", "fig-5-10").stdout == hydrohil("show", "fig-5-9").stdout


def test_what_show_prints_as_toml_is_the_experiment_and_runs(tmp_path: Path):
    printed = hydrohil("show", EXPERIMENT, "--toml").stdout
    tomllib.loads(printed)
    mine = tmp_path / "mine.toml"
    mine.write_text(printed)
    assert load(mine) == find(EXPERIMENT)
    assert hydrohil("run", str(mine), *LOCAL).exit_code == 0


def test_a_run_whose_claims_hold_ends_with_0_and_says_so():
    run = hydrohil("run", EXPERIMENT, *LOCAL)
    assert run.exit_code == 0, run.output
    assert "NO" not in run.stdout.replace("NO VERDICT", "")


def test_a_claim_that_fails_ends_with_1():
    run = hydrohil("run", EXPERIMENT, *LOCAL, "--set", "claims.0.low=0.0", "--set", IMPOSSIBLE)
    assert run.exit_code == 1, run.output
    assert "NO" in run.stdout


def test_a_trip_ends_with_3_and_names_rule_number_and_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)  # where its report goes
    run = hydrohil("run", "fig-5-5", *LOCAL, "--set", "supervisor.force_limit_n=50.0")
    assert run.exit_code == 3, run.output
    assert "contact force reached 5" in run.stdout and "N against its limit of 50.0 N" in run.stdout


def test_the_report_holds_every_claim_with_its_number(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file = Path("new") / "r.json"
    hydrohil("run", EXPERIMENT, *LOCAL, "--seed", "3", "--json", str(file))
    document = json.loads(file.read_text())
    assert (document["experiment"], document["clock"], document["seed"], document["exit_status"]) == (EXPERIMENT, "local", 3, 0)
    assert [claim["statement"] for claim in document["claims"]] == [claim.statement for claim in find(EXPERIMENT).claims]
    assert all(isinstance(claim["measured"], float) and claim["holds"] for claim in document["claims"])
    assert document["tripped"] is None and document["gap"] is None


def test_the_trace_holds_every_column_of_every_sample(tmp_path: Path):
    file = tmp_path / "t.npz"
    hydrohil("run", EXPERIMENT, *LOCAL, "--trace", str(file))
    trace = read_trace(file)
    ticks = round(find(EXPERIMENT).duration_s / 4.5e-3)
    assert list(trace.tick) == list(range(ticks))
    assert all(len(getattr(trace, field)) == ticks for field in Trace._fields)
    assert set(trace.mode) == {Mode.RUNNING}
    assert np.all(np.diff(trace.t_s) > 0)


def test_the_seed_changes_the_run_and_repeats_it(tmp_path: Path):
    counts = []
    for name, seed in (("a.npz", "1"), ("b.csv", "1"), ("c.npz", "2")):
        hydrohil("run", EXPERIMENT, *LOCAL, "--seed", seed, "--trace", str(tmp_path / name))
        counts.append(read_trace(tmp_path / name).force_counts)
    assert np.array_equal(counts[0], counts[1])
    assert not np.array_equal(counts[0], counts[2])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("run", "fig-4-26"), ("fig-4-26", "fig-4-25")),
        (("show", "final-sin"), ("final-sin", "final-sine")),
        (("run", EXPERIMENT, "--set", "controller.lew=pi"), ("lew", "law")),
        (("run", EXPERIMENT, "--set", "plant.initial_q.out_in=1.05"), ("initial_q", "1.05 m", "1.04")),
        (("run", EXPERIMENT, "--set", "duration_s=3601.0"), ("3601", "s", "3600")),
        (("run", EXPERIMENT, "--set", "duration_s"), ("path=value",)),
        (("run", "fig-5-2", "--set", "controller.impedance.stiffness_n_per_m=-5.0"), ("-5.0 N/m", "greater than 0")),
        (("run", "fig-5-2", "--set", "controller.impedance.mass_kg=0.0"), ("0.0 kg", "greater than 0")),
        (("run", "fig-5-2", "--set", "controller.impedance.mass_kg=nan"), ("NaN kg", "finite")),
        (("run", "fig-5-2", "--set", "reference.0.amount=2000.0"), ("2000 N on 500 N/m", "down/up (high, 0.471 rad)")),
        (("run", EXPERIMENT, "--clock", "sidereal"), ("sidereal", "real, lockstep or local")),
        (("run", EXPERIMENT, *LOCAL, "--rrd", "x.rrd"), ("--rrd", "--trace")),
        (("run", EXPERIMENT, *LOCAL, "--trace", "x.xls"), ("x.xls", ".npz, .csv, .parquet")),
        (("run", "nowhere/mine.toml", *LOCAL), ("nowhere/mine.toml",)),
        (("run", "fig-6-4", *LOCAL), ("fig-6-4 is a computed figure", "hydrohil reproduce --only fig-6-4")),
        (("show", "force-filter"), ("computed figure", "hydrohil reproduce --only force-filter")),
    ],
)
def test_wrong_usage_ends_with_2_and_says_what_is_expected(arguments: tuple[str, ...], words: tuple[str, ...]):
    run = hydrohil(*arguments)
    assert run.exit_code == 2, run.output
    assert all(word in run.stderr for word in words), run.stderr
    assert "Traceback" not in run.output


def test_a_limit_itself_is_accepted():
    assert hydrohil("show", EXPERIMENT, "--set", "duration_s=3600.0").exit_code == 0


@pytest.mark.parametrize(("text", "words"), [("name = ", "no TOML"), ('name = "x"\n', "missing"), ("\x00", "no TOML")])
def test_a_bad_file_ends_with_2_and_is_named(tmp_path: Path, text: str, words: str):
    file = tmp_path / "bad.toml"
    file.write_text(text)
    run = hydrohil("run", str(file), *LOCAL)
    assert run.exit_code == 2
    assert str(file) in run.stderr and words in run.stderr


READERS = ("run", "show", "linear", "tune", "campaign", "view", "trip")


@pytest.mark.parametrize("command", READERS)
@pytest.mark.parametrize("content", ["missing", "folder", "no text"])
def test_a_file_that_cannot_be_read_is_named_in_one_line_and_ends_with_2(command: str, content: str, tmp_path: Path):
    file = tmp_path / "nope.toml"
    if content == "folder":
        file.mkdir()
    elif content == "no text":
        file.write_bytes(b"\xff\xfe")
        if command == "view":
            file.chmod(0)
            if os.access(file, os.R_OK):
                pytest.skip("root reads every file")
    run = hydrohil(command, str(file))
    assert run.exit_code == 2, run.output
    assert str(file) in run.stderr and len(run.stderr.splitlines()) == 1
    assert "Errno" not in run.stderr and "Traceback" not in run.output


def test_a_file_that_cannot_be_written_ends_with_2_before_the_run(tmp_path: Path):
    (tmp_path / "file").write_text("")
    run = hydrohil("run", EXPERIMENT, *LOCAL, "--json", str(tmp_path / "file" / "r.json"))
    assert run.exit_code == 2, run.output
    assert str(tmp_path / "file") in run.stderr


def test_view_without_a_recording_says_how_to_make_one(tmp_path: Path):
    view = hydrohil("view", str(tmp_path / "none.rrd"))
    assert view.exit_code == 2
    assert "--rrd" in view.stderr


def test_view_opens_every_file_of_a_long_recording(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    files = [tmp_path / name for name in ("run.rrd", "run.part2.rrd", "run.part3.rrd")]
    for path in (*files, tmp_path / "other.rrd"):
        path.touch()
    opened: list[list[str]] = []
    monkeypatch.setattr("os.execv", lambda _viewer, line: opened.append(line[1:]))
    for path in files:
        hydrohil("view", str(path))
    assert opened == [[str(path) for path in files]] * 3


def test_what_must_limit_cycle_is_warned_of_before_it_runs_and_in_the_report(tmp_path: Path):
    file = tmp_path / "r.json"
    (line,) = warnings(find("fig-5-13"))
    assert f"warning: {line}" in hydrohil("show", "fig-5-13").stdout
    run = hydrohil("run", "fig-5-13", *LOCAL, "--json", str(file))
    assert run.stdout.count("warning: ") == 1
    assert run.stdout.startswith(f"warning: {line}")
    assert json.loads(file.read_text())["warnings"] == [line]


def test_what_cannot_limit_cycle_is_not_warned_of(tmp_path: Path):
    file = tmp_path / "r.json"
    assert "warning" not in hydrohil("show", "fig-7-4").stdout
    assert "warning" not in hydrohil("run", EXPERIMENT, *LOCAL, "--json", str(file)).stdout
    assert json.loads(file.read_text())["warnings"] == []


def test_down_without_up_says_so():
    down = hydrohil("down", "--cell", "nobody-started-this")
    assert down.exit_code == 2
    assert "hydrohil up" in down.stderr


def test_status_of_a_cell_that_is_not_up_says_how_to_start_it(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Cell, "status", lambda _: {})
    status = hydrohil("status", "--cell", "nobody-started-this", "--port", "7990")
    assert status.exit_code == 5
    assert "cell 'nobody-started-this' is not up: `hydrohil up` starts it" in status.stdout


@pytest.mark.parametrize("option", ["--json", "--trace"])
def test_a_full_disk_and_a_folder_for_a_file_are_reported_in_one_line_and_are_no_failed_claim(option: str, tmp_path: Path):
    folder = hydrohil("run", EXPERIMENT, *LOCAL, option, str(tmp_path))
    (tmp_path / "full.npz").symlink_to("/dev/full")
    full = hydrohil("run", EXPERIMENT, *LOCAL, option, str(tmp_path / "full.npz"))
    assert (folder.exit_code, full.exit_code) == (2, 2)
    assert "is a folder" in folder.stderr and "No space left" in full.stderr
    assert len(full.stderr.strip().splitlines()) == 1
