"""Reports on disk: whole or not at all, by a thread of its own."""

import json
import os
import threading
from pathlib import Path

import pytest

from hydrohil.shared.trips import files as trip_files
from hydrohil.shared.trips.files import TripFiles, read, reports, write
from tests.support.trip_scene import report


def test_what_is_written_is_read_again_bit_for_bit(tmp_path: Path):
    document = report()
    path = write(tmp_path / "new", document)
    assert path.name == "20261122T234000Z-force-tared.json"
    assert read(path) == document
    assert json.loads(path.read_text())["signals"]["plant/sample"]["number"]
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


def test_a_second_trip_in_the_same_second_gets_a_file_of_its_own(tmp_path: Path):
    paths = [write(tmp_path, report()) for _ in range(3)]
    assert len(set(paths)) == 3
    assert set(reports(tmp_path)) == set(paths)


def test_the_oldest_go_and_what_is_no_report_stays(tmp_path: Path, monkeypatch):
    monkeypatch.setattr(trip_files, "KEPT", 2)
    (tmp_path / "mine.json").write_text("{}")
    small = report() | {"signals": {}}
    paths = [write(tmp_path, small | {"utc": f"2026-11-22T23:40:0{i}Z"}) for i in range(4)]
    assert reports(tmp_path) == paths[2:]
    assert (tmp_path / "mine.json").exists()


@pytest.mark.parametrize("text", ["", "{", "[]", '{"format": "other"}'])
def test_what_is_no_report_is_said_in_one_line(tmp_path: Path, text: str):
    path = tmp_path / "x.json"
    path.write_text(text)
    with pytest.raises(ValueError, match=f"{path} is no trip report"):
        read(path)


def test_the_thread_writes_and_reports_where(tmp_path: Path):
    files, document = TripFiles(tmp_path), report()
    files.put(document)
    files.close()
    assert read(Path(files.path_of(document))) == document
    assert files.path_of(dict(document)) == "" and files.failure == ""


def test_a_folder_that_cannot_be_created_is_one_line_and_nothing_else(tmp_path: Path, capsys):
    (tmp_path / "file").write_text("")
    files = TripFiles(tmp_path / "file" / "trips")
    files.put(report())
    files.close()
    assert capsys.readouterr().err.count("\n") == 1
    assert "file" in files.failure


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_full_disk_is_one_line_and_leaves_no_part(tmp_path: Path, monkeypatch, capsys):
    def full(self: Path, text: str) -> int:
        with open("/dev/full", "w") as device:
            device.write(text)
        return len(text)

    files, document = TripFiles(tmp_path), report()
    with monkeypatch.context() as patched:
        patched.setattr(Path, "write_text", full)
        files.put(document)
        files.close()
    assert "No space left" in files.failure
    assert capsys.readouterr().err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_the_next_report_is_written_when_there_is_room_again(tmp_path: Path, capsys):
    blocked = tmp_path / "trips"
    blocked.write_text("")
    files, document = TripFiles(blocked), report()
    files.put(document)
    while not files.failure:
        pass
    blocked.unlink()
    files.put(document)
    files.close()
    assert files.path_of(document) and files.failure == ""


def test_a_folder_that_hangs_delays_no_caller(tmp_path: Path, monkeypatch, capsys):
    let_go = threading.Event()
    monkeypatch.setattr(trip_files, "write", lambda folder, document: let_go.wait() and folder)
    files = TripFiles(tmp_path)
    document = report()
    for _ in range(20):
        files.put(document)
    assert "too many wait" in files.failure
    files.close(timeout_s=0.01)
    let_go.set()
