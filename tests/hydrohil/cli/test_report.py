"""What is said of a run: on the terminal, in a recording's document, as JSON; and the exit status that follows from it."""

import json
import math

import pytest
from rich.console import Console

from hydrohil.claims.claims import Verdict
from hydrohil.cli.report import show
from hydrohil.experiment.run import BY_HAND, Run
from hydrohil.services.controller.config import ScheduledChange
from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.host.qualified import Qualified
from hydrohil.thesis.library import find

EXPERIMENT = find("fig-4-25")
HOLDS, FAILS = (Verdict(EXPERIMENT.claims[0], 1.0, held) for held in (True, False))


def report(verdicts: tuple[Verdict, ...] = (HOLDS,), trip: str = "", gap: str = "") -> Run:
    return Run(EXPERIMENT, "real", 4, verdicts=verdicts, trip=trip, gap=gap, wall_s=10.0)


@pytest.mark.parametrize(
    ("run", "status"),
    [
        (report(), 0),
        (report(()), 0),
        (report((HOLDS, FAILS)), 1),
        (report((FAILS,), gap="command of tick 3 is missing"), 5),
        (report((HOLDS,), trip="the raw force is above its limit"), 3),
        (report((FAILS,), trip="the raw force is above its limit", gap="command of tick 3 is missing"), 3),
    ],
)
def test_the_worst_of_it_decides_the_exit_status(run: Run, status: int):
    assert run.exit_status == status


def as_json(run: Run) -> dict:
    return json.loads(json.dumps(run.report(), allow_nan=False))


def shown(run: Run) -> str:
    console = Console(width=200, record=True, file=None, quiet=False)
    with console.capture() as capture:
        show(console, run)
    return capture.get()


def test_a_gap_is_said_to_give_no_verdict():
    assert "NO VERDICT: command of tick 3 is missing" in shown(report((), gap="command of tick 3 is missing"))


def test_a_trip_is_said_with_its_words():
    assert "TRIPPED: too much" in shown(report((), trip="too much"))


@pytest.mark.parametrize(("trial_time_s", "words"), [(1.0966, "1.1 of 20 s"), (-0.5, "0 of 20 s"), (None, "20 s")])
def test_a_trial_that_tripped_says_how_far_it_came_and_no_speed(trial_time_s, words):
    document = {"sentence": "", "must_hold": "", "to_do": "", "ages": [], "counters": {}, "trial_time_s": trial_time_s}
    assert f", {words} in 10.00 s\n" in shown(report((), trip="too much")._replace(trip_report=document))
    assert ", 20 s in 10.00 s (2 times real time)\n" in shown(report())


def test_claims_are_shown_as_stated_measured_and_whether_they_hold():
    table = shown(report((HOLDS, FAILS)))
    assert EXPERIMENT.claims[0].statement in table
    assert "yes" in table and "NO" in table


def test_without_numbers_the_latencies_are_dashes():
    run = report()._replace(latencies={"samples": 7, "lateness_us": {}})
    assert "7" in shown(run) and "-" in shown(run)


def test_the_document_marks_what_fails():
    assert "**NO**" in report((FAILS,)).to_markdown()
    assert "**NO**" not in report((HOLDS,)).to_markdown()


def test_a_number_that_is_none_is_null_in_json():
    document = as_json(report((Verdict(EXPERIMENT.claims[0], math.nan, False),)))
    assert document["claims"][0]["measured"] is None
    assert (document["exit_status"], document["clock"], document["seed"]) == (1, "real", 4)


def test_warnings_are_in_the_document_and_in_json():
    warned = report()._replace(warnings=("it must limit-cycle",))
    document = as_json(warned)
    assert document["warnings"] == ["it must limit-cycle"]
    assert "**warning**: it must limit-cycle" in warned.to_markdown()
    assert "warning" not in report().to_markdown()


def test_what_was_broken_on_purpose_is_said_everywhere():
    faults = (Fault("drop", "supply", 2.0, 1.0, 0.5), Fault("stuck", "force"))
    run = report()._replace(experiment=EXPERIMENT._replace(faults=faults))
    for text in (shown(run), run.to_markdown()):
        assert "drop supply 0.5 share at 2 s for 1 s" in text and "stuck force at 0 s to the end" in text
    document = as_json(run)
    assert document["faults"] == [fault._asdict() for fault in faults]


def test_the_report_carries_how_the_host_is_qualified_or_that_it_is_not():
    found = Qualified(
        qualified_period_ns=4_500_000,
        grade="B",
        measured_at="yesterday",
        period_ns=4_500_000,
        samples=4444,
        late_share=0.0005,
        accepted_p999_us=1400.0,
        wake_up_max_us=12_000.0,
        lease_ms=36.0,
    )._asdict()
    document = [as_json(run) for run in (report()._replace(qualification=found), report(), report()._replace(clock="local"))]
    assert [one["qualification"] for one in document] == [found, None, None]
    assert "qualified for 222.2 Hz, grade B (yesterday)" in document[0]["qualified"]
    assert "not qualified" in document[1]["qualified"] and document[2]["qualified"] is None


def test_a_run_whose_parameters_were_changed_by_hand_has_no_verdict_whatever_its_claims_say():
    line = "changed by hand at sample 40: controller.law"
    for verdicts in ((HOLDS,), (FAILS,), ()):
        run = report(verdicts)._replace(changed_by_hand=(line,))
        assert run.exit_status == 5
        assert f"NO VERDICT: {BY_HAND}" in shown(run) and line in shown(run)
        assert BY_HAND in run.to_markdown() and line in run.to_markdown()
    assert report((HOLDS,), trip="too much")._replace(changed_by_hand=(line,)).exit_status == 3
    document = as_json(report()._replace(changed_by_hand=(line,)))
    assert (document["changed_by_hand"], document["exit_status"], document["claims"][0]["holds"]) == ([line], 5, True)
    assert BY_HAND not in shown(report()) and "by hand" not in report().to_markdown()


def test_scheduled_changes_are_said_and_leave_the_verdict():
    changes = (ScheduledChange(2.5, ("controller.law=pi",)),)
    run = report()._replace(experiment=EXPERIMENT._replace(changes=changes))
    assert run.exit_status == 0
    assert "at 2.5 s: controller.law=pi" in shown(run) and "at 2.5 s: controller.law=pi" in run.to_markdown()
    document = as_json(run)
    assert document["changes"] == [{"at_s": 2.5, "set": ["controller.law=pi"]}]
