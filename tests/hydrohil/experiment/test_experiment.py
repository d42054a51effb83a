import hashlib
import json
import math
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.claims.claims import Claim
from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import (
    Experiment,
    experiment_hash,
    from_bytes,
    from_plain,
    to_bytes,
    to_plain,
    to_toml,
)
from hydrohil.services.controller.config import ControllerConfig, Segment
from hydrohil.services.controller.params import OUT_IN_GAINS, UNIMATE_GAINS
from hydrohil.thesis.library import catalogue, load

CLAIM = Claim(
    "it follows",
    metric="rms_error",
    channel="q2",
    comparison="below",
    start_s=0.0,
    end_s=5.0,
    unit="deg",
    high=0.1,
    source="none",
)
EXPERIMENT = Experiment(
    "a-step",
    "step",
    "A step",
    "made for this test",
    5.0,
    controller=ControllerConfig(target="joint"),
    reference=(Segment("q2", "step", 1.0, amount=0.1), Segment("q2", "sine", 2.0, 1.0, 0.01, frequency_hz=1.0, amount_end=0.0)),
    claims=(CLAIM, CLAIM._replace(statement="und es hält – auch größer", low=-0.0, high=1e-17)),
)


def written(tmp_path, text):
    path = tmp_path / "trial.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_an_experiment_survives_toml_exactly(tmp_path):
    again = load(written(tmp_path, to_toml(EXPERIMENT)))
    assert again == EXPERIMENT
    assert to_bytes(again) == to_bytes(EXPERIMENT)


def test_an_experiment_survives_bytes_exactly():
    assert from_bytes(to_bytes(EXPERIMENT)) == EXPERIMENT


@given(
    st.floats(allow_nan=False, allow_infinity=False), st.text(st.characters(exclude_categories=("Cc", "Cf", "Cs", "Zl", "Zp")))
)
def test_every_number_and_text_survives_to_the_last_bit(number, text):
    changed = EXPERIMENT._replace(title=text, claims=(CLAIM._replace(high=number),))
    assert from_bytes(to_bytes(changed)) == changed
    again = from_plain(tomllib.loads(to_toml(changed)), "test")
    assert again == changed
    assert math.copysign(1.0, again.claims[0].high) == math.copysign(1.0, number)


def test_every_default_is_spelled_out():
    plain = tomllib.loads(to_toml(EXPERIMENT))
    for section in ("plant", "controller", "supervisor"):
        assert set(plain[section]) == set(getattr(EXPERIMENT, section)._fields)
    for link in ("rotate", "down_up", "out_in"):
        assert len(plain["plant"]["machine"][link]) == len(EXPERIMENT.plant.machine.down_up)
        assert len(plain["controller"]["gains"][link]) == len(EXPERIMENT.controller.gains.down_up)


@pytest.mark.parametrize("experiment", catalogue(), ids=lambda experiment: str(experiment.name))
def test_what_is_written_as_toml_loads_back_equal(experiment):
    assert from_plain(tomllib.loads(to_toml(experiment)), "trial.toml") == experiment


def test_the_hash_is_that_of_the_bytes_as_sent():
    data = to_bytes(EXPERIMENT)
    assert experiment_hash(data) == hashlib.sha256(data).digest()
    assert experiment_hash(data) != experiment_hash(to_bytes(EXPERIMENT._replace(duration_s=5.001)))


def test_the_bytes_are_canonical():
    data = to_bytes(EXPERIMENT)
    plain = json.loads(data)
    assert list(plain) == sorted(plain)
    assert b", " not in data.split(b'"claims"')[0]
    whole_numbers = from_plain({**to_plain(EXPERIMENT), "duration_s": 5}, "test")
    assert to_bytes(whole_numbers) == data


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(ExperimentError, match=r"nowhere\.toml: cannot be read .*: give the path of a TOML file"):
        load(tmp_path / "nowhere.toml")


def test_bad_syntax_is_named_with_its_line(tmp_path):
    with pytest.raises(ExperimentError, match=r"trial\.toml: is no TOML: .*line 2.*; correct"):
        load(written(tmp_path, 'name = "a"\nalias = \n'))


def test_bytes_that_are_no_json_are_refused():
    with pytest.raises(ExperimentError, match="is no JSON"):
        from_bytes(b"\xff{")


def refused(**changes):
    """Lines of the error for the experiment with dotted fields changed."""
    plain = to_plain(EXPERIMENT)
    for name, value in changes.items():
        *path, last = name.split("__")
        place = plain
        for part in path:
            place = place[int(part) if part.isdecimal() else part]
        place[last] = value
    with pytest.raises(ExperimentError) as refusal:
        from_plain(plain, "trial.toml")
    return refusal.value.problems


def test_a_wrong_type_is_refused_not_converted():
    assert refused(duration_s="5") == ('trial.toml: duration_s is "5": expected a valid number; correct the value',)
    assert refused(duration_s=True) == ("trial.toml: duration_s is true: expected a valid number; correct the value",)
    (line,) = refused(plant__sample_period_substeps=90.5)
    assert "plant.sample_period_substeps is 90.5 sub-steps: expected a valid integer" in line


def test_an_unknown_field_is_refused_with_the_nearest_names():
    (line,) = refused(controller__gains__down_up__kp_a_per_deg=215)
    assert line.startswith("trial.toml: controller.gains.down_up.kp_a_per_deg is no field: remove it or use one of kp_a_per_rad")
    (line,) = refused(controller__gains__out_in__kp_a_per_rad=215)
    assert line.startswith("trial.toml: controller.gains.out_in.kp_a_per_rad is no field: remove it or use one of kp_a_per_m")
    assert refused(controller__gains__out_in__kp_a_per_q=215) == (
        "trial.toml: controller.gains.out_in.kp_a_per_q is no field: use kp_a_per_m",
    )
    (line,) = refused(durations_s=5.0)
    assert line == "trial.toml: durations_s is no field: remove it or use one of duration_s"


def test_a_value_out_of_bounds_is_named_with_its_unit():
    (line,) = refused(controller__gains__down_up__kp_a_per_rad=-3.0)
    assert "controller.gains.down_up.kp_a_per_rad is -3.0 A/rad: expected greater than or equal to 0; correct the value" in line
    (line,) = refused(plant__machine__out_in__viscous_n_s_per_m=-1.0)
    assert "plant.machine.out_in.viscous_n_s_per_m is -1.0 N s/m: expected" in line
    (line,) = refused(plant__initial_q__out_in=1.05)
    assert line == "trial.toml: plant.initial_q.out_in is 1.05 m: expected less than or equal to 1.04; correct the value"


def test_links_go_by_name_and_a_list_of_them_is_refused_with_their_names():
    (line,) = refused(plant__initial_q=[0.0, 0.0, 0.5])
    assert line == (
        "trial.toml: plant.initial_q is a list: links go by name, "
        "write plant.initial_q.rotate, plant.initial_q.down_up, plant.initial_q.out_in"
    )
    (line,) = refused(controller__gains=[{}, {}, {}])
    assert line.startswith("trial.toml: controller.gains is a list: links go by name, write controller.gains.rotate")


def test_a_table_of_one_link_keeps_the_other_values_of_that_link():
    plain = to_plain(EXPERIMENT)
    plain["controller"]["gains"] = {"out_in": {"kp_a_per_m": 3.0}}
    gains = from_plain(plain, "trial.toml").controller.gains
    assert gains == UNIMATE_GAINS._replace(out_in=OUT_IN_GAINS._replace(kp_a_per_q=3.0))


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
def test_no_number_that_is_not_finite_gets_in(value):
    (line,) = refused(supervisor__workspace_low_m=[value, 0.0, 0.0])
    assert "supervisor.workspace_low_m.0" in line and "expected a finite number" in line
    assert refused(claims__0__high=value)


def test_a_missing_field_is_named():
    plain = to_plain(EXPERIMENT)
    del plain["duration_s"]
    with pytest.raises(ExperimentError, match=r"trial\.toml: duration_s is missing: add it, in s"):
        from_plain(plain, "trial.toml")


def test_a_date_is_no_value(tmp_path):
    with pytest.raises(ExperimentError, match=r"trial\.toml: .*use text, numbers"):
        load(written(tmp_path, "name = 2020-01-01\n"))


def test_every_problem_has_its_own_line():
    lines = refused(duration_s=0.0, title=3)
    assert len(lines) == 2


def test_sections_that_do_not_fit_together_are_refused():
    assert "plant.latch_substeps is 91" in refused(plant__latch_substeps=91)[0]
    assert "crate_static_friction" in refused(plant__environment__crate_static_friction=0.28)[0]
    assert "reads x, y or z" in refused(controller__target="cartesian")[0]


def test_a_claim_that_does_not_fit_is_refused():
    assert "claims.1.unit is N: rms_error of q2 is stated in one of rad, deg" in refused(claims__1__unit="N")[0]
    assert refused(claims__0__end_s=5.1)[0].startswith("trial.toml: claims.0.end_s is 5.1 s")
    assert "claims.0.metric" in refused(claims__0__metric="niceness")[0]


@pytest.mark.parametrize("nested", ["[" * 100_000, '{"plant":' + "[" * 100_000])
def test_an_experiment_nested_without_end_is_refused_in_words(nested, tmp_path):
    with pytest.raises(ExperimentError, match="is no JSON"):
        from_bytes(nested.encode())
    deep = tmp_path / "deep.toml"
    deep.write_text("a = " + "[" * 100_000)
    with pytest.raises(ExperimentError, match="is no TOML"):
        load(deep)
