import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from rerun.chunk import RrdReader

from hydrohil.services.recorder import service
from hydrohil.services.recorder.recorder import Recorder
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.requests import Request
from tests.recorder.test_recording import read, texts
from tests.support.recorder_trial import DESCRIPTION, TARE_TICKS, trial


class Asked:
    """A request, and what was answered."""

    def __init__(self, recorder: Recorder, folder: Path, verb: str, **arguments: Any):
        self.answers: list[tuple[bool, str, dict[str, Any]]] = []
        service._answer(recorder, [], folder, Request(verb, arguments, lambda *answer: self.answers.append(answer)))
        ((self.accepted, self.reason, self.values),) = self.answers  # exactly one


def test_record_status_and_finish_are_answered_with_what_was_written(tmp_path: Path):
    recorder = Recorder("bench")
    assert Asked(recorder, tmp_path, "record", path="a/b.rrd", title="t").values["path"] == str(tmp_path / "a" / "b.rrd")
    recorder.take(trial(20))
    assert Asked(recorder, tmp_path, "status").values["received"]["plant/sample plant"]["received"] == 20 + TARE_TICKS + 30
    finished = Asked(recorder, tmp_path, "finish", summary_markdown="# PASS").values
    assert finished["gaps"] == 0
    assert finished["bytes"] == (tmp_path / "a" / "b.rrd").stat().st_size


QUALIFICATION = {
    "qualified_period_ns": 4_500_000,
    "grade": "B",
    "measured_at": "2026-11-28 02:00:00+00:00",
    "period_ns": 4_500_000,
    "samples": 4444,
    "late_share": 0.0005,
    "accepted_p999_us": 1400.0,
    "wake_up_max_us": None,
    "lease_ms": 36.0,
}


@pytest.mark.parametrize(
    ("qualification", "words", "grade"),
    [(QUALIFICATION, "qualified for 222.2 Hz, grade B (2026-11-28", ["B"]), (None, "not qualified", [])],
)
def test_a_recording_carries_how_its_host_is_qualified(tmp_path: Path, qualification: Any, words: str, grade: list[str]):
    recorder = Recorder("bench")
    asked = Asked(recorder, tmp_path, "record", path="x.rrd", title="t", qualification=qualification)
    assert asked.accepted, asked.reason
    Asked(recorder, tmp_path, "finish", summary_markdown="# PASS")
    documents = texts(tmp_path / "x.rrd", "summary", "TextDocument:text")
    assert len(documents) == 2 and all(words in text for text in documents)
    properties = property_columns(tmp_path / "x.rrd", "qualification")
    assert properties.get("grade", []) == grade
    assert words in properties["words"][0] and "wake_up_max_us" not in properties


def test_a_recording_names_the_machine_that_the_plant_describes(tmp_path: Path):
    recorder = Recorder("bench")
    Asked(recorder, tmp_path, "record", path="x.rrd", title="t")
    recorder.take(list(trial(5)))
    Asked(recorder, tmp_path, "finish", summary_markdown="# PASS")
    properties = property_columns(tmp_path / "x.rrd", "machine")
    assert (properties["machine"], properties["hash"]) == (["unimate"], [DESCRIPTION.machine_hash.hex()])


def property_columns(path: Path, name: str) -> dict[str, list[Any]]:
    """Values of a recording's property, by column."""
    found = {}
    for chunk in RrdReader(path).stream():
        if str(chunk.entity_path) == f"/__properties/{name}":
            batch = chunk.to_record_batch()
            found |= {
                column: [v for row in batch.column(column).to_pylist() if row for v in row] for column in batch.schema.names
            }
    return found


def test_a_qualification_that_is_none_is_refused(tmp_path: Path):
    asked = Asked(Recorder("bench"), tmp_path, "record", path="x.rrd", title="t", qualification={"grade": "A"})
    assert not asked.accepted and "qualification" in asked.reason
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("path", ["", "trial.txt", "a/b"])
def test_a_name_that_is_no_recording_is_refused(tmp_path: Path, path: str):
    asked = Asked(Recorder("bench"), tmp_path, "record", path=path)
    assert not asked.accepted
    assert "ends in .rrd" in asked.reason
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_created_is_refused_with_its_name(tmp_path: Path):
    (tmp_path / "file").write_text("")
    asked = Asked(Recorder("bench"), tmp_path, "record", path="file/x.rrd", title="t")
    assert not asked.accepted
    assert "file" in asked.reason


def test_an_unknown_request_is_refused_with_the_known_ones(tmp_path: Path):
    asked = Asked(Recorder("bench"), tmp_path, "rewind")
    assert not asked.accepted
    assert "record, finish, status" in asked.reason


def test_the_shell_imports_no_rerun_before_it_starts():
    code = "import sys, hydrohil.services.recorder.service; sys.exit('rerun' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def free_ports() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


SENT = 400 + TARE_TICKS + 30


def started(plant: Bus, port: int, folder: Path) -> subprocess.Popen[bytes]:
    """A recorder that records into run.rrd from its start, once it hears the plant."""
    arguments = ["--cell", "bench", "--port", str(port), "--folder", str(folder), "--rrd", "run.rrd"]
    process = subprocess.Popen([sys.executable, "-m", "hydrohil.services.recorder", *arguments])
    deadline = time.monotonic() + 20.0
    while "recorder" not in plant.alive() and time.monotonic() < deadline:
        time.sleep(0.1)
    time.sleep(0.5)  # its subscriptions follow its token
    return process


def publish(plant: Bus) -> None:
    """A trial's samples and truths; then time to write them."""
    for message in trial(400):
        if message.header.sender == "plant":
            plant.publish(message.topic, message.body, (message.header.echo_number, 0))
            time.sleep(0.0005)
    time.sleep(1.0)


@pytest.mark.live
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_a_recorder_that_is_stopped_leaves_a_whole_file(tmp_path: Path, number: signal.Signals):
    port = free_ports()
    with Bus("plant", "bench", port, 1) as plant:
        process = started(plant, port, tmp_path)
        try:
            publish(plant)
        finally:
            process.send_signal(number)
            assert process.wait(20.0) == 0
    assert RrdReader(tmp_path / "run.rrd").store() is not None
    assert len(read(tmp_path / "run.rrd", "topic/plant/sample", "sample")[0]) == SENT


@pytest.mark.live
def test_a_recorder_killed_outright_leaves_every_batch_that_was_written(tmp_path: Path):
    port = free_ports()
    with Bus("plant", "bench", port, 1) as plant:
        process = started(plant, port, tmp_path)
        try:
            publish(plant)
        finally:
            process.kill()
            process.wait(20.0)
    with pytest.warns(Warning):  # no footer
        assert len(read(tmp_path / "run.rrd", "topic/plant/sample", "sample")[0]) == SENT
