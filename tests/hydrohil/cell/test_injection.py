import json

import pytest
from typer.testing import CliRunner

from hydrohil.cell.injection import INJECTORS, SCHEDULED, refused, unplayable
from hydrohil.cli.main import app
from hydrohil.shared.contract.faults import ROWS, Fault

ONE_OF_EACH = [Fault(row.kind, row.targets[0], value=row.low) for row in ROWS]


@pytest.mark.parametrize(("fault", "row"), list(zip(ONE_OF_EACH, ROWS, strict=True)))
def test_a_fault_is_taken_where_somebody_plays_it_and_refused_everywhere_else(fault, row):
    assert (refused(fault) == "") is (row.group in INJECTORS)
    for clock in ("local", "lockstep", "real"):
        assert (unplayable([fault], clock) == []) is (row.group in SCHEDULED and clock in row.clocks)


@pytest.mark.parametrize(
    "fault",
    [
        Fault("stuck", "nothing"),
        Fault("stuck", "force", value=1.0),
        Fault("stuck", "force", lasts_s=-1.0),
        Fault("stuck", "force", float("nan")),
    ],
)
def test_what_cannot_be_injected_is_said_before_anybody_is_asked(fault):
    assert "\n" not in refused(fault) and refused(fault)


def test_the_list_has_every_row_with_its_unit_and_bounds():
    listed = json.loads(CliRunner().invoke(app, ["inject", "--list", "--json"]).stdout)
    assert [(row["kind"], tuple(row["targets"])) for row in listed] == [(row.kind, row.targets) for row in ROWS]
    leak = next(row for row in listed if row["kind"] == "leak")
    assert (leak["unit"], leak["low"], leak["high"], leak["injected"]) == ("times", 1.0, 1000.0, True)
    assert "cross-port" in CliRunner().invoke(app, ["inject", "--list"]).stdout


@pytest.mark.parametrize("clock", ["local", "lockstep"])
def test_a_run_refuses_what_its_clock_cannot_break_before_anything_starts(clock):
    done = CliRunner().invoke(app, ["run", "fig-4-25", "--clock", clock, "--inject", "kill controller at=1"])
    assert done.exit_code == 2


def test_a_value_that_is_not_given_is_asked_for_before_a_cell_is():
    done = CliRunner().invoke(app, ["inject", "drop", "supply"])
    assert done.exit_code == 2
    assert "value of drop is missing, expected 0..1 share: give --value" in done.stderr
