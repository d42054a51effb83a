"""One cause explained: its rule, its condition of the gate, its default limit."""

import pytest

from hydrohil.explanation.causes import default_limit, explain
from hydrohil.shared.contract.messages import GateCause, TripCause
from hydrohil.shared.errors import HydrohilError, UnknownNameError


def test_a_rule_with_a_unit_has_its_default_limit():
    assert default_limit(TripCause.FORCE_TARED) == "334.1 N"
    assert default_limit(TripCause.GATE_CUT) == ""
    assert default_limit(TripCause.ESTOP) == ""


def test_a_name_that_supervisor_and_gate_share_is_explained_for_both():
    assert [(one.cause, one.by) for one in explain("estop")] == [("ESTOP", "supervisor"), ("ESTOP", "gate")]
    assert [one.by for one in explain("gate.ESTOP")] == ["gate"]


@pytest.mark.parametrize("name", [*(c.name for c in TripCause if c), *(f"gate.{c.name}" for c in GateCause if c)])
def test_every_cause_says_what_must_hold_and_what_to_do(name: str):
    for one in explain(name):
        assert one.must_hold and one.to_do, one


def test_an_unknown_cause_is_an_error_of_the_library_that_gives_the_nearest():
    with pytest.raises(UnknownNameError, match="FORCE_RAW") as caught:
        explain("force-rav")
    assert isinstance(caught.value, HydrohilError)
