"""A recording is read back as it was written: every topic, exact, by the names that the messages have."""

from pathlib import Path

import numpy as np
import pytest

from hydrohil.recording.recording import Recording, read_recording
from hydrohil.services.recorder.recorder import Recorder
from hydrohil.shared.errors import FileError
from tests.support.recorder_trial import PERIOD_NS, TARE_TICKS, trial

MESSAGES = list(trial(200, trip_tick=180))


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    path = tmp_path_factory.mktemp("run") / "trial.rrd"
    recorder = Recorder("bench")
    recorder.record(path, "Static force control", "# before")
    for k in range(0, len(MESSAGES), 40):
        recorder.take(MESSAGES[k : k + 40])
        recorder.tick(k * 10_000_000)
    recorder.finish("# Verdict: PASS")
    return read_recording(str(path))


@pytest.mark.parametrize(
    ("topic", "field"),
    [
        ("plant/sample", "encoder_counts"),
        ("plant/sample", "force_counts"),
        ("controller/command", "dac_counts"),
        ("controller/state", "q"),
        ("controller/state", "force_n"),
        ("supervisor/permit", "mode"),
    ],
)
def test_every_field_comes_back_exactly_by_its_name(recording: Recording, topic: str, field: str):
    written = np.array([getattr(m.body, field) for m in MESSAGES if m.topic == topic], dtype=float)
    np.testing.assert_array_equal(recording[topic][field], written)


def test_the_time_of_the_trial_is_the_samples_own_and_nan_outside(recording: Recording):
    samples = recording["plant/sample"]
    inside = samples.trial_s[~np.isnan(samples.trial_s)]
    np.testing.assert_array_equal(inside, PERIOD_NS * np.arange(-TARE_TICKS, 200) / 1e9)
    np.testing.assert_array_equal(samples.sample, samples["number"])
    assert np.isnan(samples.trial_s[0])


def test_the_verdict_is_its_summary_and_its_topics_are_listed(recording: Recording):
    assert recording.summary.startswith("# Verdict: PASS")
    assert {"plant/sample", "plant/gate", "controller/state"} <= set(recording.topics)
    assert "plant/sample" in repr(recording) and "force_counts" in repr(recording["plant/sample"])
    assert list(recording) == list(recording.topics)
    with pytest.raises(KeyError, match=r"trial\.rrd has no topic 'plant/nothing': it has .*plant/sample"):
        recording["plant/nothing"]


def test_what_is_no_recording_is_one_line_that_names_the_file(recording: Recording, tmp_path: Path):
    text, half = tmp_path / "text.rrd", tmp_path / "half.rrd"
    text.write_text("no recording")
    half.write_bytes(recording.path.read_bytes()[:100_000])
    for path in (text, half):
        with pytest.raises(FileError, match=f"{path.name} is no recording") as refused:
            read_recording(path)
        assert "\n" not in str(refused.value)
    with pytest.raises(FileNotFoundError):
        read_recording(tmp_path / "nothing.rrd")
