"""The recorder and a trip: into the file, the recording, the log and the status, whether or not anything is recorded."""

from pathlib import Path

from hydrohil.services.recorder.recorder import Recorder
from hydrohil.services.recorder.rows import Rows
from hydrohil.shared.trips.files import read, reports
from tests.support.trip_scene import GATE, SUPERVISOR, TRIP_NUMBER, link_stats, tripping


def rows_of(recorder: Recorder) -> list[Rows]:
    """Everything that it emits from now on."""
    emitted: list[Rows] = []
    recorder._emit = emitted.append  # type: ignore[method-assign]
    recorder._writer._emit = emitted.append
    return emitted


def test_a_trip_is_reported_though_no_recording_is_open(tmp_path: Path):
    recorder = Recorder("bench", trips=tmp_path)
    recorder.take([link_stats(3), *tripping(SUPERVISOR)])
    recorder.tick(0)
    recorder.close()
    (file,) = reports(tmp_path)
    document = read(file)
    assert (document["sample"], document["cell"], document["receiver"]) == (TRIP_NUMBER, "bench", "the recorder's")
    assert document["counters"]["plant"]["controller/command"]["lost"] == 2
    assert document["counters"]["recorder"]["plant/sample"] == {"missing": 0, "unordered": 0}
    status = recorder.status()["trip"]
    assert (status["path"], status["sample"], status["failure"]) == (str(file), TRIP_NUMBER, "")


def test_a_trip_without_a_folder_has_a_report_and_no_file():
    recorder = Recorder("bench")
    recorder.take(tripping(GATE))
    recorder.tick(0)
    assert recorder.status()["trip"]["cause"] == "FORCE_ABOVE_LIMIT"
    assert recorder.status()["trip"]["path"] == ""


def test_the_open_recording_gets_a_document_and_a_line(tmp_path: Path):
    recorder = Recorder("bench", trips=tmp_path / "trips")
    recorder.record(tmp_path / "a.rrd", "a")
    emitted = rows_of(recorder)
    recorder.take(tripping(SUPERVISOR))
    recorder.tick(0)
    (document,) = [rows.values for rows in emitted if rows.entity == "trip"]
    assert document.startswith("## Trip: FORCE_TARED")
    assert any(rows.entity == "log/recorder" and "trip report" in rows.values[0][1] for rows in emitted)


def test_a_recording_that_is_finished_right_after_the_trip_has_it_too(tmp_path: Path):
    recorder = Recorder("bench", trips=tmp_path / "trips")
    recorder.record(tmp_path / "a.rrd", "a")
    emitted = rows_of(recorder)
    recorder.take(m for m in tripping(SUPERVISOR) if m.header.echo_number <= TRIP_NUMBER + 5)
    recorder.tick(0)
    assert not [rows for rows in emitted if rows.entity == "trip"]
    recorder.finish()
    assert [rows for rows in emitted if rows.entity == "trip"]


def test_a_recorder_that_ends_right_after_the_trip_writes_it(tmp_path: Path):
    recorder = Recorder("bench", trips=tmp_path)
    recorder.take(m for m in tripping(SUPERVISOR) if m.header.echo_number <= TRIP_NUMBER + 5)
    recorder.close()
    assert len(reports(tmp_path)) == 1


def test_an_unwritable_folder_leaves_everything_else_as_it_was(tmp_path: Path, capsys):
    (tmp_path / "file").write_text("")
    recorder = Recorder("bench", trips=tmp_path / "file")
    recorder.record(tmp_path / "a.rrd", "a")
    emitted = rows_of(recorder)
    recorder.take(tripping(SUPERVISOR))
    recorder.tick(0)
    recorder.close()
    assert [rows for rows in emitted if rows.entity == "trip"]
    assert recorder.status()["trip"]["failure"]
    assert next(line for line in capsys.readouterr().err.splitlines() if "trip" in line).startswith("recorder: a trip report")
