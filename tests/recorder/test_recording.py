from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
import rerun as rr
from rerun.chunk import RrdReader

from hydrohil.services.recorder.recorder import Recorder
from hydrohil.services.recorder.recording import Recording, unused
from hydrohil.services.recorder.rows import Rows
from hydrohil.shared.contract.codec import Received, Rejected
from hydrohil.shared.contract.messages import PlantDescription
from tests.support.recorder_trial import PERIOD_NS, TARE_TICKS, exact, trial


def read(path: Path, entity: str, timeline: str) -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) as they were written, and scalars (n, k)."""
    times, values = [], []
    for chunk in RrdReader(path).stream().filter(content=f"/{entity}"):
        if chunk.is_static or timeline not in chunk.timeline_names:
            continue
        batch = chunk.to_record_batch()
        column = batch.column("Scalars:scalars")
        values.append(column.flatten().to_numpy(zero_copy_only=False).reshape(len(column), -1))
        times.append(batch.column(timeline).cast(pa.int64()).to_numpy())
    t, v = np.concatenate(times), np.concatenate(values)
    order = np.argsort(t, kind="stable")
    return t[order], v[order]


def entities(path: Path) -> set[str]:
    return {str(chunk.entity_path) for chunk in RrdReader(path).stream()}


def texts(path: Path, entity: str, component: str) -> list[str]:
    chunks = [c for c in RrdReader(path).stream().filter(content=f"/{entity}") if c.entity_path == f"/{entity}"]
    columns = [c.to_record_batch() for c in chunks]
    return [t for b in columns if component in b.schema.names for row in b.column(component).to_pylist() if row for t in row]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Received], dict]:
    """One trial with two missing truths, one refused frame and a trip; its file and the recorder's report."""
    rr.set_strict_mode(True)
    path = tmp_path_factory.mktemp("run") / "trial.rrd"
    messages = [m for m in trial(200, trip_tick=180) if not (m.topic == "plant/ground_truth" and m.header.seq in (300, 301))]
    recorder = Recorder("bench")
    recorder.record(path, "Static force control", "# before")
    for k in range(0, len(messages), 40):
        recorder.take(messages[k : k + 40])
        recorder.tick(k * 10_000_000)
    recorder.take([Rejected(1, "plant/sample", "crc", "checksum differs")])
    return path, messages, recorder.finish("# Verdict: PASS")


@pytest.mark.parametrize(
    "topic", ["plant/sample", "plant/ground_truth", "controller/state", "controller/command", "supervisor/permit"]
)
def test_every_topic_reads_back_exactly(recorded: tuple[Path, list[Received], dict], topic: str):
    path, messages, report = recorded
    expected = exact([m for m in messages if m.topic == topic])
    _, values = read(path, f"topic/{topic}", "sample")
    np.testing.assert_array_equal(values, expected)
    assert report["rows_by_topic"][topic] == len(expected)


def test_the_trial_time_is_the_samples_own(recorded: tuple[Path, list[Received], dict]):
    times, _ = read(recorded[0], "topic/plant/sample", "trial_time")
    np.testing.assert_array_equal(times, PERIOD_NS * np.arange(-TARE_TICKS, 200))


def test_the_file_has_its_footer_its_layout_and_the_arm(recorded: tuple[Path, list[Received], dict]):
    reader = RrdReader(recorded[0])
    assert reader.store() is not None
    assert len(reader.blueprints()) == 1
    found = entities(recorded[0])
    assert {"/tf_static", "/scene/joint/rotate", "/scene/joint/pitch", "/summary", "/machine", "/log/gate"} <= found
    assert any("tool" in entity for entity in found if entity.startswith("/scene/unimate"))


def test_the_gaps_are_counted_exactly_and_stand_in_the_recording(recorded: tuple[Path, list[Received], dict]):
    path, _, report = recorded
    assert report["gaps"] == 2
    assert report["gaps_by_topic"]["plant/ground_truth plant"] == 2
    assert read(path, "missing/plant/ground_truth/plant", "sample")[1][-1] == 2.0
    assert read(path, "missing/plant/sample/plant", "sample")[1].max() == 0.0
    lines = texts(path, "log/recorder", "TextLog:text")
    assert "2 missing on plant/ground_truth from plant: 300 to 301" in lines
    assert "1 refused on plant/sample: crc, checksum differs" in lines


def test_the_summary_ends_as_the_verdict_with_the_counts(recorded: tuple[Path, list[Received], dict]):
    last = texts(recorded[0], "summary", "TextDocument:text")[-1]
    assert last.startswith("# Verdict: PASS")
    assert "| plant/ground_truth | 672 | 2 |" in last


def test_the_report_has_what_the_operator_prints(recorded: tuple[Path, list[Received], dict]):
    path, messages, report = recorded
    assert report["path"] == str(path)
    assert report["rows"] == len(messages)
    assert report["bytes"] == path.stat().st_size
    assert report["failure"] == ""


def test_an_existing_file_is_never_truncated(tmp_path: Path):
    path = tmp_path / "trial.rrd"
    path.write_text("precious")
    assert [unused(path).name for _ in range(2)] == ["trial-2.rrd", "trial-3.rrd"]
    with Recording(path, "again") as recording:
        assert recording.path.name == "trial-4.rrd"
    assert path.read_text() == "precious"


def test_a_full_disk_is_reported_and_counting_goes_on(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr("hydrohil.services.recorder.recording.unused", lambda path: Path("/dev/full"))
    recorder = Recorder("bench")
    assert "No space left" in recorder.record(tmp_path / "trial.rrd", "no room")["failure"]
    recorder.take(m for m in trial(20) if m.header.seq != 100)
    assert "No space left" in recorder.status()["recording"]["failure"]
    report = recorder.finish()
    assert report["gaps"] == 5
    assert "No space left" in report["failure"]
    ours = [line for line in capsys.readouterr().err.splitlines() if line.startswith("recorder:")]
    assert len(ours) == 1


def test_a_disk_that_fills_up_is_found_at_the_next_look(tmp_path: Path):
    with Recording(tmp_path / "trial.rrd", "fills up") as recording:
        assert recording.check() == ""

        def full(timeout_sec: float) -> None:
            raise RuntimeError("File-writer thread shut down prematurely")

        recording._stream.flush = full
        assert "shut down" in recording.check()
        before = recording.rows
        recording.write(Rows("log/x", "document", None, "lost"))
        assert recording.rows == before


def test_a_slow_disk_is_no_failure(tmp_path: Path):
    with Recording(tmp_path / "trial.rrd", "slow") as recording:

        def slow(timeout_sec: float) -> None:
            raise RuntimeError("Flush timed out")

        recording._stream.flush = slow
        assert recording.check() == ""
        del recording._stream.flush


def test_without_a_recording_everything_is_counted_and_nothing_written(tmp_path: Path):
    recorder = Recorder("bench")
    recorder.take(m for m in trial(20) if m.header.seq != 100)
    status = recorder.status()
    assert status["recording"]["path"] == ""
    assert status["received"]["plant/ground_truth plant"]["missing"] == 1
    assert recorder.finish()["failure"] == "no recording is open"


def test_gaps_before_a_recording_are_not_its_own(tmp_path: Path):
    messages = list(trial(20))
    recorder = Recorder("bench")
    recorder.take(m for m in messages if m.header.seq < 200 and m.header.seq != 100)
    recorder.record(tmp_path / "trial.rrd", "later")
    recorder.take(m for m in messages if m.header.seq >= 200 and m.header.seq != 300)
    assert recorder.finish()["gaps"] == 5


def test_the_next_record_closes_the_one_before(tmp_path: Path):
    recorder = Recorder("bench")
    messages = list(trial(20))
    for _ in range(2):
        recorder.record(tmp_path / "trial.rrd", "one")
        recorder.take(messages)
    recorder.finish()
    for name in ("trial.rrd", "trial-2.rrd"):
        assert RrdReader(tmp_path / name).store() is not None
        assert len(read(tmp_path / name, "topic/plant/sample", "sample")[0]) == 30 + TARE_TICKS + 20


def test_the_layout_follows_the_axis_of_the_force_gauge(tmp_path: Path):
    messages = [m._replace(body=m.body._replace(force_axis=0)) if isinstance(m.body, PlantDescription) else m for m in trial(5)]
    recorder = Recorder("bench")
    recorder.record(tmp_path / "trial.rrd", "crate")
    recorder.take(messages)
    report = recorder.finish()
    assert report["failure"] == ""
    assert RrdReader(tmp_path / "trial.rrd").blueprints()
