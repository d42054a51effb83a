"""`hydrohil linear` on the command line."""

import json

import pytest
from typer.testing import CliRunner, Result

from hydrohil.cli.main import app


def hydrohil(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments))


def test_linear_prints_poles_margins_and_gains():
    shown = hydrohil("linear", "fig-5-5")
    assert shown.exit_code == 0, shown.output
    for word in ("damping", "gain margin", "modulus margin", "F/F_d 1.005", "stable"):
        assert word in shown.stdout
    assert "unstable" not in shown.stdout


def test_as_json_it_is_whole_and_knows_no_infinity():
    found = json.loads(hydrohil("linear", "fig-5-5", "--json").stdout)
    assert found["steady"]["f_per_f_d"] == pytest.approx(1.0045, abs=1e-4)
    assert found["loop"]["gain"] is None  # nothing crosses -180 deg
    assert len(found["poles"]) > len(json.loads(hydrohil("linear", "fig-5-5", "--json", "--ideal").stdout)["poles"])


def test_a_changed_impedance_and_another_current_change_the_model():
    soft = json.loads(hydrohil("linear", "fig-5-5", "--json", "--set", "controller.impedance.stiffness_n_per_m=500.0").stdout)
    assert soft["steady"]["f_per_f_d"] == pytest.approx(1.0, abs=0.01)
    slow = json.loads(hydrohil("linear", "fig-5-5", "--json", "--current-ma", "60").stdout)
    assert slow["valve_loop"]["phase_rad_per_s"] < soft["valve_loop"]["phase_rad_per_s"]


def test_a_loop_that_the_model_has_unstable_is_called_so():
    shown = hydrohil("linear", "fig-5-9", "--current-ma", "60")
    assert shown.exit_code == 0
    assert "unstable" in shown.stdout


def test_bode_plots_are_written(tmp_path):
    assert hydrohil("linear", "fig-5-2", "--png", str(tmp_path / "bode.png")).exit_code == 0
    assert (tmp_path / "bode.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("fig-4-2",), "controller.target is joint"),
        (("fig-5-5", "--current-ma", "36"), "overlap of 36 mA"),
        (("fig-5-55",), "is no experiment"),
        (("fig-5-5", "--png", "/proc/no/bode.png"), "does not exist"),
        (("torque-static-force-stiff-plate",), "controller.law is torque"),
        (("adaptive-offset",), "controller.adaptation.kind is offset"),
    ],
)
def test_what_has_no_linear_model_is_refused_in_one_line(arguments, said):
    refused = hydrohil("linear", *arguments)
    assert refused.exit_code == 2
    assert said in refused.stderr
