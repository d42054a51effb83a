"""The fault test in one call: what it reports, and what it refuses."""

import pytest

from hydrohil.faulttest import run
from hydrohil.faulttest.execution import Execution
from hydrohil.faulttest.matrix import UnknownRowError
from hydrohil.faulttest.run import FaultTestProgress, run_fault_tests
from hydrohil.faulttest.tally import HELD


def test_rows_on_the_local_clock_start_no_cell_and_report_each_trial():
    reports: list[FaultTestProgress] = []
    report = run_fault_tests(["18"], trials=1, quick=True, progress=reports.append)
    assert [result.verdict for result in report.results] == [HELD] and report.exit_status == 0
    assert [(one.done, one.total, one.trial is None) for one in reports] == [
        (0, 2, True),
        (1, 2, False),
        (1, 2, True),
        (2, 2, False),
    ]
    assert report.lease_ms != report.lease_ms  # NaN: no cell was needed


def test_an_interrupt_leaves_what_was_complete(monkeypatch: pytest.MonkeyPatch):
    def interrupted(execution: Execution) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(run.Execution, "play", interrupted)
    report = run_fault_tests(["18"])
    assert report.interrupted and all(not way.trials for result in report.results for way in result.tried)


def test_an_unknown_row_is_refused_before_anything_is_started():
    with pytest.raises(UnknownRowError, match="99"):
        run_fault_tests(["99"], progress=lambda _: pytest.fail("something is started"))
