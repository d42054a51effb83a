"""Whether a recording is whole: closed with its footer, and how much is in it."""

import pytest
import rerun as rr

from hydrohil.recording.reading import chunks_of


def recorded(path, values=20):
    stream = rr.RecordingStream("test")
    stream.save(path)
    for value in range(values):
        stream.set_time("tick", sequence=value)
        stream.log("signal", rr.Scalars(float(value)))
    stream.disconnect()
    return path


def test_a_closed_recording_has_chunks(tmp_path):
    assert chunks_of(recorded(tmp_path / "whole.rrd")) > 0


def test_a_recording_without_its_end_is_refused_by_name(tmp_path):
    whole = recorded(tmp_path / "whole.rrd", 2000).read_bytes()
    cut = tmp_path / "cut.rrd"
    cut.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match=r"cut\.rrd: "):
        chunks_of(cut)


@pytest.mark.parametrize("content", [b"", b"no recording"])
def test_what_is_no_recording_is_refused_by_name(tmp_path, content):
    other = tmp_path / "other.rrd"
    other.write_bytes(content)
    with pytest.raises(ValueError, match=r"other\.rrd: "):
        chunks_of(other)


def test_a_missing_file_is_refused_by_name(tmp_path):
    with pytest.raises(ValueError, match=r"none\.rrd: "):
        chunks_of(tmp_path / "none.rrd")
