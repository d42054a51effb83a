"""Another experiment with other values: the same paths, bounds and lines as `--set`."""

import numpy as np
import pytest

import hydrohil as hh
from hydrohil.experiment.overrides import with_overrides

EXPERIMENT = hh.load("fig-5-5")


def test_values_are_those_of_the_command_line():
    changed = EXPERIMENT.with_values({"controller.law": "pi", "controller.gains.down_up.kp_a_per_rad": 9.0})
    assert changed == with_overrides(EXPERIMENT, ["controller.law=pi", "controller.gains.down_up.kp_a_per_rad=9.0"])
    assert EXPERIMENT.controller.law != "pi"


def test_a_refusal_says_the_same_as_the_command_line():
    for values, assignment in (
        ({"controller.law": "pj"}, "controller.law=pj"),
        ({"controller.lore": "pi"}, "controller.lore=pi"),
        ({"duration_s": -1.0}, "duration_s=-1.0"),
    ):
        with pytest.raises(hh.ExperimentError) as by_value:
            EXPERIMENT.with_values(values, where="--set")
        with pytest.raises(hh.ExperimentError) as by_line:
            with_overrides(EXPERIMENT, [assignment])
        assert by_value.value.problems == by_line.value.problems


def test_every_wrong_path_is_named_at_once():
    with pytest.raises(hh.ExperimentError) as refused:
        EXPERIMENT.with_values({"plant.nothing": 1, "controller.lore": "pi"})
    assert len(refused.value.problems) == 2 and all(line.startswith("with_values ") for line in refused.value.problems)


def test_numbers_of_numpy_and_sections_are_taken():
    changed = EXPERIMENT.with_values({"duration_s": np.float64(3.0), "claims": (), "plant.bias_s": np.float32(1.5)})
    assert (changed.duration_s, changed.claims, changed.plant.bias_s) == (3.0, (), 1.5)
    slower = EXPERIMENT.with_values({"plant.sample_period_substeps": np.int64(100), "plant.jitter_substeps": 0})
    assert slower.plant.sample_period_substeps == 100
    environment = hh.Environment(kind="free")
    assert EXPERIMENT.with_values({"plant.environment": environment}).plant.environment == environment


def test_faults_are_added_as_lines_or_as_faults_and_judged_like_a_file():
    fault = hh.Fault("stuck", "force", 1.0, 0.5)
    assert EXPERIMENT.with_faults("stuck force at=1.0 for=0.5") == EXPERIMENT.with_faults(fault)
    assert EXPERIMENT.with_faults(fault).faults == (fault,)
    with pytest.raises(hh.ExperimentError, match=r"with_faults: faults\.0"):
        EXPERIMENT.with_faults(hh.Fault("stuck", "nothing"))


def test_what_was_written_in_python_is_validated_before_it_runs():
    wrong = EXPERIMENT._replace(duration_s=-1.0)
    for use in (hh.validate, hh.simulate):
        with pytest.raises(hh.ExperimentError, match=r"duration_s is -1\.0 s: expected greater than 0"):
            use(wrong)
