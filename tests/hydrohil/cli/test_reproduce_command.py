"""`hydrohil reproduce` from the command line, on the local clock."""

import errno
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest
from junitparser import JUnitXml
from typer.testing import CliRunner, Result

from hydrohil.cli.main import app
from hydrohil.cli.reproduce_command import JUNIT, PAGE, write_whole
from hydrohil.reproduction.pool import Pool

TRIAL, COMPUTED = "fig-4-24", "fig-4-12"


def reproduce(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["reproduce", *arguments])


@pytest.fixture(scope="module")
def reproduced(tmp_path_factory: pytest.TempPathFactory) -> SimpleNamespace:
    """One trial and one computed figure, with two seeds."""
    out = tmp_path_factory.mktemp("reproduced")
    run = reproduce("--only", TRIAL, COMPUTED, "--seeds", "2", "--workers", "1", "--out", str(out), "--json", str(out / "r.json"))
    assert run.exit_code in (0, 1), run.output
    return SimpleNamespace(run=run, out=out, document=json.loads((out / "r.json").read_text()))


def test_page_junit_and_json_are_written_and_nothing_else(reproduced: SimpleNamespace):
    assert sorted(path.name for path in reproduced.out.iterdir()) == sorted([PAGE, JUNIT, "r.json"])
    ElementTree.fromstring((reproduced.out / PAGE).read_text())
    assert reproduced.document["exit_status"] == reproduced.run.exit_code


def test_all_three_give_the_same_number_of_claims(reproduced: SimpleNamespace):
    xml = JUnitXml.fromfile(str(reproduced.out / JUNIT))
    assert xml.tests == reproduced.document["claims"] and xml.tests - xml.failures == reproduced.document["hold"]
    assert f"{reproduced.document['hold']} of {reproduced.document['claims']} claims hold" in (reproduced.out / PAGE).read_text()
    assert f"{reproduced.document['hold']} of {reproduced.document['claims']} claims hold" in reproduced.run.stdout


def test_a_trial_is_judged_with_every_seed_and_a_computed_figure_once(reproduced: SimpleNamespace):
    seeds = {figure["name"]: {claim["seeds"] for claim in figure["claims"]} for figure in reproduced.document["figures"]}
    assert seeds == {TRIAL: {2}, COMPUTED: {1}}
    assert (reproduced.out / PAGE).read_text().count("<svg") == 2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("fig-4-26",), ("fig-4-26", "fig-4-25")),
        (("--only", "5", "fig-99"), ("fig-99",)),
        ((TRIAL, "--clock", "sidereal"), ("sidereal", "local, lockstep or real")),
        (("--clock", "real"), ("trials take", "--only")),
        ((TRIAL, "--seeds", "0"), ("--seeds", "1")),
    ],
)
def test_wrong_usage_ends_with_2_and_says_what_is_expected(arguments: tuple[str, ...], words: tuple[str, ...]):
    run = reproduce(*arguments)
    assert run.exit_code == 2, run.output
    assert all(word in run.output for word in words), run.output
    assert "Traceback" not in run.output


def test_a_folder_that_cannot_be_created_ends_with_2_before_anything_is_played(tmp_path: Path):
    (tmp_path / "file").write_text("")
    run = reproduce(TRIAL, "--out", str(tmp_path / "file" / "x"))
    assert run.exit_code == 2
    assert str(tmp_path / "file") in run.stderr


def test_a_lost_worker_ends_with_5(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def killed(self: Pool, jobs: object) -> list[None]:
        return [self.submit(os._exit, 9).result()]

    monkeypatch.setattr(Pool, "run", killed)
    run = reproduce(TRIAL, "--workers", "1", "--out", str(tmp_path))
    assert run.exit_code == 5, run.output
    assert "worker" in run.stderr


def test_interrupted_it_ends_with_130_and_leaves_neither_files_nor_processes(tmp_path: Path):
    line = [sys.executable, "-m", "hydrohil", "reproduce", "--seeds", "99", "--out", str(tmp_path)]
    with subprocess.Popen(line, start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        workers = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        while len(workers.read_text().split()) < 2 and process.poll() is None:  # what tracks resources, and a worker
            time.sleep(0.05)
        children = workers.read_text().split()
        os.killpg(process.pid, signal.SIGINT)  # as the terminal does
        _, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    assert "Traceback" not in errors
    assert list(tmp_path.iterdir()) == []
    deadline = time.monotonic() + 10.0  # the tracker ends after the process that it looks after
    while any(_lives(pid) for pid in children) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not [pid for pid in children if _lives(pid)]


def _lives(pid: str) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path):
    path = tmp_path / "page.html"
    write_whole(path, "old")
    with pytest.raises(UnicodeEncodeError):
        write_whole(path, "half \ud800 a character")
    assert path.read_text() == "old"
    assert [found.name for found in tmp_path.iterdir()] == ["page.html"]


def test_a_pipe_is_written_to_and_stays_one(tmp_path: Path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    end = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    write_whole(path, "all of it")
    assert os.read(end, 100) == b"all of it"
    os.close(end)
    assert path.is_fifo()


def test_a_full_disk_takes_the_files_and_not_the_verdicts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("hydrohil.cli.reproduce_command.write_whole", full)
    run = reproduce(COMPUTED, "--workers", "1", "--out", str(tmp_path))
    assert run.exit_code == 2  # 1 would say that a claim fails
    assert "claims hold" in run.stdout
    assert "cannot be written (No space left on device)" in run.stderr
