"""`hydrohil campaign` as a process: interrupted, killed, gone on with, on a cluster by its address, refused."""

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import psutil
import pyarrow.parquet as pq
import pytest
from distributed import LocalCluster
from typer.testing import CliRunner, Result

from hydrohil.cli.main import app
from tests.support.campaign_scene import table, write

REPEATS = 50  # 300 trials: long enough to be killed in the middle
PICTURES = {
    "error": {"kind": "distribution", "of": "error_n", "by": "controller.law"},
    "peak": {"kind": "map", "of": "peak_n", "x": "mass_kg", "y": "mass_kg"},
}


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)  # results go to runs/ where nothing else is said


def campaign(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["campaign", *map(str, arguments)])


def cut(file: Path, out: Path, number: int) -> SimpleNamespace:
    """Run as a process until one more part is there, then send it a signal."""
    parts = out / ".tiny.parts"
    before = len(list(parts.glob("*.arrow")))
    words = [sys.executable, "-m", "hydrohil", "campaign", str(file), "--out", str(out), "--workers", "1"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    while process.poll() is None and len(list(parts.glob("*.arrow"))) <= before:
        time.sleep(0.002)
    workers = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(number)
    printed, _ = process.communicate()
    _, left = psutil.wait_procs(workers, timeout=20.0)
    return SimpleNamespace(
        status=process.returncode, printed=printed, parts=len(list(parts.glob("*.arrow"))), started=workers, left=left
    )


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("campaign"), repeats=REPEATS, pictures=PICTURES)


@pytest.fixture(scope="module")
def broken(file: Path, tmp_path_factory: pytest.TempPathFactory) -> SimpleNamespace:
    """Interrupted, then killed, then run to the end."""
    out = tmp_path_factory.mktemp("broken")
    interrupted, killed = cut(file, out, signal.SIGINT), cut(file, out, signal.SIGKILL)
    last = campaign(file, "--out", out, "--workers", 1, "--json", out / "s.json")
    return SimpleNamespace(out=out, interrupted=interrupted, killed=killed, last=last)


@pytest.fixture(scope="module")
def whole(file: Path, tmp_path_factory: pytest.TempPathFactory) -> SimpleNamespace:
    """In one go, on a cluster by its address."""
    out = tmp_path_factory.mktemp("whole")
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, protocol="tcp://", dashboard_address=None) as local:
        return SimpleNamespace(out=out, run=campaign(file, "--out", out, "--scheduler", local.scheduler_address))


def test_ctrl_c_ends_with_130_and_says_how_to_go_on(broken: SimpleNamespace, file: Path):
    assert broken.interrupted.status == 130, broken.interrupted.printed
    assert re.search(
        rf"interrupted: \d+ of 300 trials are kept .*go on with: hydrohil campaign {file}", broken.interrupted.printed
    )
    assert "Traceback" not in broken.interrupted.printed


def test_a_campaign_that_was_interrupted_and_killed_goes_on_where_it_was(broken: SimpleNamespace):
    assert broken.killed.status == -signal.SIGKILL
    assert 0 < broken.interrupted.parts < broken.killed.parts
    assert broken.last.exit_code == 0, broken.last.output
    printed = json.loads((broken.out / "s.json").read_text())
    assert 0 < printed["ran_now"] < 300 and f"goes on: {300 - printed['ran_now']} of 300" in broken.last.stdout
    assert printed["ended"] == {"completed": 300, "tripped": 0, "refused": 0}


@pytest.mark.parametrize("how", ["interrupted", "killed"])
def test_its_workers_end_with_it(broken: SimpleNamespace, how: str):
    ended = getattr(broken, how)
    assert ended.started and not ended.left


def test_its_table_is_that_of_one_that_was_never_stopped_and_ran_on_a_cluster(broken: SimpleNamespace, whole: SimpleNamespace):
    assert whole.run.exit_code == 0, whole.run.output
    first, second = (pq.read_table(out / "tiny.parquet") for out in (broken.out, whole.out))
    assert first.num_rows == 300 and first.column("trial").to_pylist() == list(range(300))
    assert first.equals(second, check_metadata=True)


def test_nothing_but_table_pictures_and_lock_is_left(whole: SimpleNamespace):
    assert sorted(path.name for path in whole.out.iterdir()) == [".tiny.lock", "tiny-error.png", "tiny-peak.png", "tiny.parquet"]


def test_a_campaign_that_is_done_runs_nothing_and_draws_again(whole: SimpleNamespace, file: Path):
    (whole.out / "tiny-peak.png").unlink()
    again = campaign(file, "--out", whole.out)
    assert again.exit_code == 0 and "nothing was left to run" in again.stdout
    assert (whole.out / "tiny-peak.png").exists()


def test_a_changed_campaign_is_refused_with_2(whole: SimpleNamespace, tmp_path: Path):
    other = campaign(write(tmp_path, repeats=REPEATS, seed=6), "--out", whole.out)
    assert other.exit_code == 2 and "--fresh" in other.stderr and len(other.stderr.strip().splitlines()) == 1


def test_a_trial_is_shown_with_a_command_that_runs_it(file: Path, whole: SimpleNamespace, tmp_path: Path):
    shown = campaign(file, "--trial", 299).stdout
    words = shlex.split(shown.splitlines()[-1])
    alone = CliRunner().invoke(app, [*words[1:], "--trace", str(tmp_path / "t.npz")])
    assert alone.exit_code == 0, alone.output
    from hydrohil.claims.trace_files import read_trace

    row = pq.read_table(whole.out / "tiny.parquet").slice(299).to_pylist()[0]
    assert read_trace(tmp_path / "t.npz").force_n.max() == row["peak_n"]


def test_a_dry_run_says_what_would_run_and_writes_nothing(file: Path, tmp_path: Path):
    dry = campaign(file, "--dry-run", "--out", tmp_path / "none")
    assert dry.exit_code == 0 and "300 trials: 6 points, 50 of each" in dry.stdout and "about" in dry.stdout
    assert not (tmp_path / "none").exists()


def test_the_campaigns_that_ship_are_listed():
    listed = campaign("--list").stdout
    assert all(name in listed for name in ("stability-map", "law-robustness", "approach"))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "--list"),
        (("stability-mop",), "stability-map"),
        (("none.toml",), "none.toml"),
        (("stability-map", "--trial", "10000"), "0 to 9999"),
        (("stability-map", "--dry-run", "--workers", "0"), "workers"),
        (("stability-map", "--dry-run", "--json", "x.json"), "--json"),
        (("--list", "--trial", "1"), "--trial"),
        (("stability-map", "--workers", "2", "--scheduler", "tcp://127.0.0.1:1"), "--workers"),
    ],
)
def test_wrong_usage_ends_with_2_and_says_what_is_expected(arguments: tuple[str, ...], words: str):
    run = campaign(*arguments)
    assert run.exit_code == 2, run.output
    assert words in run.stderr and "Traceback" not in run.output


def test_a_bad_file_ends_with_2_and_one_line(tmp_path: Path):
    import tomli_w

    bad = tmp_path / "bad.toml"
    bad.write_text(tomli_w.dumps(table(sweep={"controller.lw": {"list": ["pi"]}})))
    run = campaign(bad)
    assert run.exit_code == 2 and "law" in run.stderr and len(run.stderr.strip().splitlines()) == 1


def test_a_folder_that_cannot_be_written_ends_with_2(file: Path):
    run = campaign(file, "--out", "/dev/null/x")
    assert run.exit_code == 2 and "/dev/null" in run.stderr


def test_a_scheduler_that_is_not_there_ends_with_5(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("hydrohil.campaign.cluster._CONNECT_S", 0.3)
    run = campaign(file, "--out", tmp_path, "--scheduler", "tcp://127.0.0.1:1")
    assert run.exit_code == 5 and "dask scheduler" in run.stderr
    assert os.path.isdir(tmp_path / ".tiny.parts")
