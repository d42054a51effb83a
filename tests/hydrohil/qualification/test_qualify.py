"""A qualification in one call, with made-up measurements: which rates are tried, what is reported, what is recorded."""

import json

import pytest

from hydrohil.qualification import qualify as qualification
from hydrohil.qualification.measure import Measured
from hydrohil.qualification.qualify import QualificationProgress, RateError, RecordError, qualify
from hydrohil.shared.errors import HydrohilError
from hydrohil.shared.host.qualified import standing
from tests.support.qualification_scene import GOOD


@pytest.fixture(autouse=True)
def host(monkeypatch, tmp_path):
    """It keeps up at 222.2 Hz and grants no real-time scheduling."""

    def measure(settings, period_substeps, progress):
        progress("wake-ups", 0.5)
        period_ns = period_substeps * 50_000
        return Measured(GOOD._replace(period_ns=period_ns, unanswered=0.0 if period_ns >= 4_500_000 else 400.0), {"fifo": False})

    monkeypatch.setenv("HYDROHIL_CACHE", str(tmp_path))
    monkeypatch.setattr(qualification, "measure", measure)


def test_rates_are_tried_until_one_is_qualified_and_the_record_says_so():
    result = qualify()
    assert [one.figures.period_ns for one in result.trials] == [1_000_000, 2_000_000, 4_500_000]
    assert (result.qualified_period_ns, result.exit_status) == (4_500_000, 0)
    assert standing(fifo=False).qualified == result.on_record and result.record_file.exists()


def test_a_qualification_may_leave_the_record_alone():
    assert qualify(record=False).record_file is None
    assert standing(fifo=False).qualified is None


def test_progress_names_rate_step_and_seconds():
    reports = []
    qualify([222.2], quick=True, progress=reports.append)
    assert reports == [QualificationProgress(period_ns=4_500_000, step="wake-ups", elapsed_s=0.5, total_s=7.5)]


def test_the_summary_is_json_and_says_none_where_no_rate_is_qualified():
    result = qualify([1000.0])
    assert (result.qualified_period_ns, result.exit_status, result.summary()["qualified_period_ns"]) == (0, 1, None)
    json.dumps(result.summary(), allow_nan=False)


@pytest.mark.parametrize("rate_hz", [0.0, 97.5, 1026.0, float("nan")])
def test_a_rate_that_no_plant_accepts_is_an_error_before_anything_is_measured(rate_hz: float):
    with pytest.raises(RateError, match="100 to 1000") as caught:
        qualify([222.2, rate_hz], progress=lambda _: pytest.fail("something is measured"))
    assert isinstance(caught.value, HydrohilError)


def test_a_record_that_cannot_be_written_keeps_what_was_measured(monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("HYDROHIL_CACHE", str(tmp_path / "file"))
    with pytest.raises(RecordError, match="cannot be written") as caught:
        qualify([222.2])
    assert caught.value.qualification.qualified_period_ns == 4_500_000
