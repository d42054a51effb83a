import math

import pytest

from shared.faults import ROWS, Fault, of_group, problem, row_of

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
