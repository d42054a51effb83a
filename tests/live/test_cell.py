"""`Cell`, the library's way into a live cell: run, break, change, stop; nothing of it is left afterwards."""

import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import hydrohil as hh

pytestmark = pytest.mark.live
NAME, PORT = "library", 7870
EXPERIMENT = hh.load("fig-5-5").with_values({"duration_s": 1.0, "claims": []})
WALL_CLOCK = {"sample_age_s"}


@pytest.fixture(scope="module")
def cell() -> Iterator[hh.Cell]:
    with hh.Cell(NAME, PORT, recorder=False) as own:
        yield own


def test_lockstep_gives_the_trace_of_simulate_and_prints_nothing(cell: hh.Cell, capfd: pytest.CaptureFixture[str]):
    times_s: list[float] = []
    live, local = cell.run(EXPERIMENT, seed=3, progress=times_s.append), hh.simulate(EXPERIMENT, seed=3)
    assert live.trace is not None and local.trace is not None
    for name, a, b in zip(hh.Trace._fields, live.trace, local.trace, strict=True):
        assert name in WALL_CLOCK or np.array_equal(a, b), name
    assert live.holds and live.clock == "lockstep" and live.latencies and times_s == sorted(times_s)
    assert capfd.readouterr() == ("", "")


def test_a_second_cell_of_that_name_is_refused_and_attaching_finds_the_first(cell: hh.Cell):
    with pytest.raises(hh.CellError, match="is up already: attach to it"):
        hh.Cell(NAME, PORT)
    for way in (hh.Cell.attach, hh.Cell.open):
        with way(NAME, PORT) as attached:
            assert attached.status()["plant"]["pid"] == cell.status()["plant"]["pid"]
    assert set(cell.status()) >= {"plant", "controller", "supervisor"}


def test_a_trip_is_a_result_and_the_next_run_needs_a_reset(cell: hh.Cell):
    run = cell.run(EXPERIMENT.with_faults("stuck force at=0.2"))
    assert run.trip and run.verdicts == () and run.trip_report is not None and run.trip_file == ""
    assert run.trip_report["sentence"] and run.exit_status == 3
    with pytest.raises(hh.TrippedError, match="the rig has tripped"):
        cell.run(EXPERIMENT)
    cell.reset()
    assert cell.run(EXPERIMENT).holds


def test_what_is_refused_is_one_error_with_one_line(cell: hh.Cell):
    refused = (
        (hh.ExperimentError, "clock is 'local'", lambda: cell.run(EXPERIMENT, clock="local")),  # type: ignore[arg-type]
        (hh.ExperimentError, "expected KIND TARGET", lambda: cell.inject("stuck")),
        (hh.RefusedError, "stuck", lambda: cell.inject(hh.Fault("stuck", "nothing"))),
        (hh.RefusedError, "refused: ", lambda: cell.set_parameters({"controller.law": "pi"})),
    )
    for kind, words, use in refused:
        with pytest.raises(kind, match=words) as error:
            use()
        assert "\n" not in str(error.value)


def test_parameters_change_while_it_runs_and_an_exception_of_the_caller_disarms(cell: hh.Cell):
    answers: list[dict] = []

    def change(trial_s: float) -> None:
        if trial_s > 0.2 and not answers:
            answers.append(cell.set_parameters({"controller.gains.down_up.kp_a_per_rad": 9.0}))

    run = cell.run(EXPERIMENT.with_values({"duration_s": 4.0}), clock="real", unqualified=True, progress=change)
    assert [one["path"] for one in answers[0]["changed"]] == ["controller.gains.down_up.kp_a_per_rad"]
    assert run.changed_by_hand and not run.holds

    def give_up(trial_s: float) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        cell.run(EXPERIMENT, progress=give_up)
    assert cell.status()["supervisor"]["mode"] == "DISARMED"


def test_an_emergency_stop_is_confirmed_and_latched(cell: hh.Cell):
    assert cell.estop().startswith("stopped: ")
    assert cell.status()["supervisor"]["mode"] == "TRIPPED"
    cell.reset()


def test_a_fault_acts_until_it_is_cleared(cell: hh.Cell):
    assert cell.inject("offset encoder_rotate value=1").startswith("begins at sample")
    assert cell.status()["plant"]["faults"]
    cell.clear()
    assert not any(cell.status()["plant"]["faults"].values())


def test_closed_the_processes_are_gone_and_nobody_answers(tmp_path: Path):
    with hh.Cell("short", PORT + 6, recorder=False) as own:
        pids = [status["pid"] for status in own.status().values()]
        own.close()
    assert not [pid for pid in pids if os.path.exists(f"/proc/{pid}")]
    with hh.Cell.attach("short", PORT + 6) as nobody:
        assert nobody.status() == {}
        with pytest.raises(hh.NotConfirmedError, match="NOT CONFIRMED"):
            nobody.estop()
