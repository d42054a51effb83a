import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from hydrohil.services.recorder import recorder as recorder_module
from hydrohil.services.recorder.recorder import FLUSH_NS, PART_CHUNKS, Recorder
from hydrohil.services.recorder.recording import unused
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.file_parts import part, parts_of
from hydrohil.shared.units import NS_PER_S
from tests.recorder.test_recording import entities, read, texts
from tests.support.recorder_trial import TARE_TICKS, exact, trial

TICKS = 500
CHUNKS_A_MINUTE = 3000  # 2200 were counted; the index of a file is as long as its chunks are many


def recorded(folder: Path, messages: list[Received], summary: str = "") -> dict:
    """Messages into a recorder that looks at the clock every 40 samples, as if they came once in 4.5 ms."""
    recorder = Recorder("bench")
    recorder.record(folder / "run.rrd", "long", "# before")
    for k in range(0, len(messages), 200):
        recorder.take(sorted(messages[k : k + 200], key=lambda m: m.topic != "plant/sample"))
        recorder.tick(k // 5 * 4_500_000)
    return recorder.finish(summary)


@pytest.fixture
def long(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> tuple[list[Path], list[Received], dict]:
    """A trial in files of 50 chunks at most, and those of one look at the clock; its messages; the recorder's report."""
    monkeypatch.setattr(recorder_module, "PART_CHUNKS", 50)
    messages = list(trial(TICKS, trip_tick=300))
    report = recorded(tmp_path, messages, summary="# Verdict: PASS")
    return [Path(name) for name in report["files"]], messages, report


def test_the_files_of_a_recording_are_numbered_and_found_from_any_of_them(tmp_path: Path):
    first = tmp_path / "run.rrd"
    names = [part(first, n) for n in (1, 2, 10, 3)]
    for path in (*names, tmp_path / "run-2.rrd", tmp_path / "other.part2.rrd", tmp_path / "run.part2.txt"):
        path.touch()
    assert [path.name for path in names] == ["run.rrd", "run.part2.rrd", "run.part10.rrd", "run.part3.rrd"]
    for path in names:
        assert [p.name for p in parts_of(path)] == ["run.rrd", "run.part2.rrd", "run.part3.rrd", "run.part10.rrd"]
    assert parts_of(tmp_path / "run-2.rrd") == [tmp_path / "run-2.rrd"]
    assert parts_of(tmp_path / "none.rrd") == []


def test_a_name_whose_later_files_are_still_there_is_not_taken_again(tmp_path: Path):
    (tmp_path / "run.part2.rrd").write_text("precious")
    assert unused(tmp_path / "run.rrd") == tmp_path / "run-2.rrd"


def test_a_long_recording_goes_on_in_another_file_and_loses_nothing(long: tuple[list[Path], list[Received], dict]):
    files, messages, report = long
    assert len(files) > 2
    assert sum(bool(_rows(path, "topic/supervisor/permit")) for path in files) > 2
    assert files == parts_of(files[-1])
    assert report["bytes"] == sum(path.stat().st_size for path in files)
    for topic in ("plant/sample", "controller/command", "supervisor/permit"):
        found = np.concatenate([values for path in files for values in _rows(path, f"topic/{topic}")])
        np.testing.assert_array_equal(found, exact([m for m in messages if m.topic == topic]))
    assert report["gaps"] == 0


def _rows(path: Path, entity: str) -> list[np.ndarray]:
    return [read(path, entity, "sample")[1]] if f"/{entity}" in entities(path) else []


def test_each_file_opens_alone_with_layout_names_modes_and_what_was_said(long: tuple[list[Path], list[Received], dict]):
    files, _, _ = long
    for path in files:
        reader = RrdReader(path)
        assert reader.store() is not None  # the footer is there
        assert len(reader.blueprints()) == 1
        found = entities(path)
        assert {"/tf_static", "/summary", "/machine", "/__properties/rig"} <= found
        if _rows(path, "topic/supervisor/permit"):
            assert "header.seq" in texts(path, "topic/supervisor/permit", "SeriesLines:names")
            assert texts(path, "state/1_supervisor", "StateChange:state")
    assert texts(files[-1], "summary", "TextDocument:text")[-1].startswith("# Verdict: PASS")
    assert texts(files[-1], "trip", "TextDocument:text")[-1].startswith("## Trip")


def test_the_files_of_a_recording_open_as_one(long: tuple[list[Path], list[Received], dict]):
    files, _, _ = long
    identities = {entry.recording_id for path in files for entry in RrdReader(path).recordings()}
    assert len(identities) == 1


def test_a_file_that_cannot_be_followed_by_another_is_a_failure_and_stays_whole(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setattr(recorder_module, "PART_CHUNKS", 50)
    recorder = Recorder("bench")
    recorder.record(tmp_path / "run.rrd", "long")
    (tmp_path / "run.part2.rrd").write_text("precious")  # by somebody else, since
    recorder.take(trial(TICKS))
    recorder.tick(NS_PER_S)
    recorder.tick(3 * NS_PER_S)
    report = recorder.finish()
    assert "run.part2.rrd" in report["failure"]
    assert (tmp_path / "run.part2.rrd").read_text() == "precious"
    assert RrdReader(tmp_path / "run.rrd").store() is not None


def test_a_minute_of_recording_is_a_bounded_number_of_chunks(tmp_path: Path):
    report = recorded(tmp_path, list(trial(round(60.0 / 0.0045))))
    chunks = sum(1 for chunk in RrdReader(Path(report["files"][0])).stream() if not chunk.is_static)
    assert chunks < CHUNKS_A_MINUTE
    assert PART_CHUNKS / CHUNKS_A_MINUTE > 10  # minutes in a file


KILLED = """
import os, signal, sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])  # the tests are not installed
from tests.support.recorder_trial import trial
from hydrohil.services.recorder.recorder import Recorder
recorder, messages = Recorder("bench"), list(trial(600))
recorder.record(Path(sys.argv[1]), "killed")
for k in range(0, len(messages), 50):
    recorder.take(messages[k : k + 50])
    recorder.tick(k // 5 * 4_500_000)
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_kill_costs_no_more_than_the_batches_that_are_being_filled(tmp_path: Path):
    path = tmp_path / "run.rrd"
    subprocess.run(
        [sys.executable, "-c", KILLED, str(path), str(Path(__file__).resolve().parents[2])],
        check=False,
        stderr=subprocess.DEVNULL,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # no footer
        numbers, _ = read(path, "topic/plant/sample", "sample")
        lines = texts(path, "log/supervisor", "TextLog:text")
    sent = 30 + TARE_TICKS + 600
    assert sent > len(numbers) > sent - (FLUSH_NS // 4_500_000 + 20)  # a second, and what comes between two looks
    assert (np.diff(numbers) == 1).all()
    assert "armed -> running" in lines  # lines of the log wait for no batch
