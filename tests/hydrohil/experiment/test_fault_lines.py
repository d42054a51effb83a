import pytest

from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import from_plain, to_plain, to_toml
from hydrohil.experiment.fault_lines import fault_of
from hydrohil.experiment.overrides import with_overrides
from hydrohil.shared.contract.faults import Fault
from hydrohil.thesis.library import find, load

EXPERIMENT = find("fig-4-25")


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("stuck force", Fault("stuck", "force")),
        ("stuck force at=1.0 for=0.5", Fault("stuck", "force", 1.0, 0.5)),
        ("offset  encoder_rotate value=-40 at=-0.5", Fault("offset", "encoder_rotate", -0.5, 0.0, -40.0)),
    ],
)
def test_a_line_says_what_breaks_where_when_and_by_how_much(line, fault):
    assert fault_of(line, "--inject") == fault
    assert EXPERIMENT.with_faults(line, "drop supply value=1").faults == (fault, Fault("drop", "supply", value=1.0))


@pytest.mark.parametrize(
    "line", ["", "stuck", "stuck at=1", "stuck force at", "stuck force when=1", "stuck force at=soon", "a b c"]
)
def test_a_line_that_says_something_else_is_refused_with_an_example(line):
    with pytest.raises(ExperimentError, match=r"such as 'stuck force at=1\.0 for=0\.5'"):
        fault_of(line, "--inject")


@pytest.mark.parametrize("line", ["stuck nothing", "leak valve_rotate value=0.5", "stuck force at=4000", "stuck force at=nan"])
def test_what_the_table_does_not_know_is_refused_as_in_a_file(line):
    with pytest.raises(ExperimentError):
        EXPERIMENT.with_faults(line)


def test_faults_may_be_set_as_a_list_changed_one_by_one_and_written_down():
    settings = ('faults=[{kind="stuck", target="force", at_s=1}]', "faults.0.at_s=2.5")
    broken = with_overrides(EXPERIMENT, settings)
    assert broken.faults == (Fault("stuck", "force", 2.5),)
    assert from_plain(to_plain(broken), "again") == broken


def test_without_a_line_nothing_changes():
    assert EXPERIMENT.with_faults() is EXPERIMENT


def test_a_value_that_is_not_given_is_asked_for_and_not_taken_as_zero():
    with pytest.raises(ExperimentError, match=r"value of drop is missing, expected 0..1 share"):
        fault_of("drop supply at=1", "--inject")
    assert fault_of("noise force value=0", "--inject").value == 0.0
    assert fault_of("stuck force", "--inject").value == 0.0


def test_a_file_that_leaves_a_value_out_is_refused_as_the_command_line_is(tmp_path):
    written = to_toml(EXPERIMENT) + '\n[[faults]]\nkind = "drop"\ntarget = "supply"\nat_s = 1.0\n'
    path = tmp_path / "broken.toml"
    path.write_text(written.replace("faults = []\n", ""))
    with pytest.raises(ExperimentError, match=r"broken.toml: faults.0: value of drop is missing, expected 0..1 share"):
        load(path)
    path.write_text(path.read_text() + "value = 0.0\n")
    assert load(path).faults == (Fault("drop", "supply", 1.0),)


def test_a_fault_after_the_trials_end_is_refused_with_its_time_and_the_trials():
    with pytest.raises(ExperimentError, match=r"faults.0: stuck of force begins at 30 s, but the trial ends at .*: let it begin"):
        EXPERIMENT.with_faults("stuck force at=30")


def test_more_faults_than_a_sample_has_time_for_are_refused():
    with pytest.raises(ExperimentError, match="faults has 33 entries, expected at most 32"):
        EXPERIMENT.with_faults(*("stuck force",) * 33)
