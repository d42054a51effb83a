import math

import pytest

from hydrohil.shared.contract.faults import MOST_FAULTS, ROWS, Fault, never_acts, of_group, problem, row_of, trial_problems

LIMITED = [row for row in ROWS if row.unit]


def test_no_kind_and_target_has_two_rows():
    named = [(row.kind, target) for row in ROWS for target in row.targets]
    assert len(named) == len(set(named))


@pytest.mark.parametrize("row", LIMITED, ids=lambda row: f"{row.kind}-{row.targets[0]}")
def test_a_value_is_accepted_on_its_bounds_and_refused_just_past_them(row):
    target = row.targets[0]
    for bound, beyond in ((row.low, -math.inf), (row.high, math.inf)):
        assert problem(Fault(row.kind, target, value=bound)) == ""
        assert "expected" in problem(Fault(row.kind, target, value=math.nextafter(bound, beyond)))
    assert "expected" in problem(Fault(row.kind, target, value=math.nan))


def test_a_value_where_none_is_taken_is_refused():
    assert "takes none" in problem(Fault("stuck", "force", value=1.0))


def test_an_unknown_kind_or_target_is_refused_with_those_there_are():
    assert "stuck, garbage" in problem(Fault("explode", "force"))
    assert "encoder_rotate" in problem(Fault("wrap", "force"))


def test_a_fault_is_refused_on_a_clock_that_cannot_play_it():
    assert "only on real" in problem(Fault("kill", "controller"), "lockstep")
    assert "only on lockstep or real" in problem(Fault("loss", "plant>controller", value=0.1), "local")
    assert problem(Fault("stuck", "force"), "local") == ""


def test_the_same_kind_means_what_its_target_says():
    assert row_of(Fault("stuck", "force")).group == "sensor"
    assert row_of(Fault("stuck", "valve_out_in")).group == "actuator"


def test_each_service_takes_its_own_rows():
    faults = (Fault("kill", "plant"), Fault("stuck", "force"), Fault("drop", "supply", value=0.5))
    assert of_group(faults, "sensor", "actuator") == faults[1:]
    assert of_group(faults, "process") == faults[:1]


PERIOD_NS, TICKS = 4_500_000, (-100, 400)  # the trial is from -0.45 to 1.8 s
STUCK = Fault("stuck", "force")


def test_a_fault_that_begins_at_the_trials_last_tick_acts_and_a_later_one_never_would():
    assert never_acts(STUCK._replace(at_s=399 * 0.0045), PERIOD_NS, TICKS) == ""
    for at_s in (399 * 0.0045 + 1e-6, 400 * 0.0045, 30.0):
        what = never_acts(STUCK._replace(at_s=at_s), PERIOD_NS, TICKS)
        assert f"stuck of force begins at {at_s:g} s, but the trial ends at 1.8 s: let it begin earlier" in what


def test_a_fault_that_is_over_before_the_trials_first_tick_never_would_act():
    assert never_acts(STUCK._replace(at_s=-1.0, lasts_s=0.5501), PERIOD_NS, TICKS) == ""
    assert "is over at -0.45 s, but the trial begins at -0.45 s" in never_acts(
        STUCK._replace(at_s=-1.0, lasts_s=0.55), PERIOD_NS, TICKS
    )
    assert never_acts(STUCK._replace(at_s=-10.0), PERIOD_NS, TICKS) == ""


def test_a_value_that_was_not_written_is_missing_and_a_written_zero_is_none():
    drop = Fault("drop", "supply")
    assert trial_problems([{"kind": "drop", "target": "supply"}], [drop], PERIOD_NS, TICKS) == [
        "faults.0: value of drop is missing, expected 0..1 share"
    ]
    assert trial_problems([["drop", "supply", 0.0, 0.0]], [drop], PERIOD_NS, TICKS) != []
    for written in ({"kind": "drop", "target": "supply", "value": 0.0}, ["drop", "supply", 0.0, 0.0, 0.0], drop):
        assert trial_problems([written], [drop], PERIOD_NS, TICKS) == []
    assert trial_problems([{"kind": "stuck", "target": "force"}], [STUCK], PERIOD_NS, TICKS) == []


def test_as_many_faults_as_a_sample_has_time_for_are_played_and_one_more_is_refused():
    faults = [STUCK] * MOST_FAULTS
    assert trial_problems(faults, faults, PERIOD_NS, TICKS) == []
    more = [*faults, STUCK]
    assert trial_problems(more, more, PERIOD_NS, TICKS) == ["faults has 33 entries, expected at most 32: leave some out"]


def test_every_fault_of_a_trial_that_is_wrong_is_named_by_its_place():
    faults = [STUCK, Fault("explode", "force"), STUCK._replace(at_s=5.0), Fault("kill", "plant")]
    found = trial_problems(faults, faults, PERIOD_NS, TICKS, "lockstep")
    assert [line.split(":")[0] for line in found] == ["faults.1", "faults.2", "faults.3"]
