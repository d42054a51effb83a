"""One call of the library is one run: its trace, its verdicts, how it ended."""

import builtins
import json

import numpy as np
import pytest

import hydrohil as hh

EXPERIMENT = hh.load("fig-5-5")


@pytest.fixture(scope="module")
def run() -> hh.Run:
    return hh.simulate(EXPERIMENT, seed=3)


def test_a_run_has_its_trace_and_a_verdict_a_claim(run: hh.Run):
    assert run.trace is not None and run.trace.force_n.shape == run.trace.t_s.shape
    assert [verdict.claim for verdict in run.verdicts] == list(EXPERIMENT.claims)
    assert run.verdicts == tuple(hh.judge(claim, run.trace) for claim in EXPERIMENT.claims)
    assert (run.clock, run.seed, run.trip, run.gap, run.trip_report) == ("local", 3, "", "", None)
    assert run.holds and run.exit_status == 0


def test_the_seed_alone_makes_the_difference(run: hh.Run):
    again, other = hh.simulate(EXPERIMENT, seed=3), hh.simulate(EXPERIMENT, seed=4)
    assert all(map(np.array_equal, run.trace, again.trace))
    assert not np.array_equal(run.trace.force_n, other.trace.force_n)


def test_a_trip_is_a_result_with_its_report_and_has_no_verdict():
    tripped = hh.simulate(EXPERIMENT.with_values({"supervisor.force_limit_n": 50.0}))
    assert tripped.trip and tripped.verdicts == () and not tripped.holds and tripped.exit_status == 3
    assert tripped.trip_report["cause"] == "FORCE_TARED" and str(tripped.trip_report["sample"]) in tripped.trip
    assert "TRIPPED" in repr(tripped) and len(tripped.trace.t_s) < len(hh.simulate(EXPERIMENT).trace.t_s)


def test_it_is_one_line_in_a_notebook_and_whole_in_json(run: hh.Run):
    assert repr(run) == "<Run fig-5-5, seed 3, clock local: 4 of 4 claims hold>"
    report = json.loads(json.dumps(run.report(), allow_nan=False))
    assert report["experiment"] == "fig-5-5" and [claim["holds"] for claim in report["claims"]] == [True] * 4
    assert run.to_markdown().startswith("# fig-5-5: ")


def test_a_fault_that_only_a_cell_can_play_is_refused():
    with pytest.raises(hh.ExperimentError, match="kill"):
        hh.simulate(EXPERIMENT.with_faults("kill controller at=1"))


def test_nothing_is_printed_and_nothing_is_written(run: hh.Run, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    hh.simulate(EXPERIMENT.with_values({"supervisor.force_limit_n": 50.0}))
    assert capfd.readouterr() == ("", "") and not list(tmp_path.iterdir())


def test_a_data_frame_has_a_column_a_link(run: hh.Run):
    table = run.to_pandas()
    assert table.index.name == "t_s"
    np.testing.assert_array_equal(table["q.down_up"], run.trace.q[:, 1])


def test_without_pandas_the_error_says_what_to_do(run: hh.Run, monkeypatch):
    imported = builtins.__import__

    def without(name, *rest, **named):
        if name == "pandas":
            raise ImportError(name)
        return imported(name, *rest, **named)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(hh.MissingPackageError, match="pip install pandas"):
        run.to_pandas()
