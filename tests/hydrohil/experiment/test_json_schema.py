"""The schema is that of what `show --json` prints: every shipped experiment passes, what is refused elsewhere fails."""

import json
import re
from pathlib import Path

import jsonschema
import pytest

from hydrohil.experiment.commented import commented_toml
from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import from_plain, to_plain
from hydrohil.experiment.json_schema import at, experiment_schema, in_words
from hydrohil.thesis.library import catalogue, find, load

VALIDATOR = jsonschema.Draft202012Validator(experiment_schema())


def test_the_schema_is_one():
    jsonschema.Draft202012Validator.check_schema(experiment_schema())
    json.dumps(experiment_schema())


@pytest.mark.parametrize("experiment", catalogue(), ids=lambda experiment: experiment.name)
def test_every_experiment_is_as_the_schema_says(experiment):
    VALIDATOR.validate(to_plain(experiment))


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("duration_s",), 0.0),
        (("duration_s",), 3600.1),
        (("duration_s",), "20"),
        (("controller", "law"), "none"),
        (("controller", "gains", "out_in", "kp_a_per_rad"), 1.0),
        (("controller", "gains", "rotate", "kp_a_per_rad"), -1e-9),
        (("plant", "initial_q", "out_in"), 1.05),
        (("supervisor", "force_limit_n"), 1e4),
        (("reference", 0, "channel"), "q4"),
        (("unknown",), 1),
    ],
)
def test_what_the_schema_refuses_is_refused_when_it_is_read(path, value):
    plain = to_plain(find("fig-4-25"))
    table = plain
    for part in path[:-1]:
        table = table[part]
    table[path[-1]] = value
    assert not VALIDATOR.is_valid(plain)
    with pytest.raises(ExperimentError):
        from_plain(plain, "here")


def test_units_are_those_of_the_link():
    schema = experiment_schema()
    assert at(schema, ("controller", "gains", "rotate", "kp_a_per_rad"))["unit"] == "A/rad"
    assert at(schema, ("controller", "gains", "out_in", "kp_a_per_m"))["unit"] == "A/m"
    assert [at(schema, ("plant", "initial_q", link))["unit"] for link in ("rotate", "out_in")] == ["rad", "m"]


def test_a_value_is_commented_with_unit_and_bounds():
    assert in_words(at(experiment_schema(), ("duration_s",))) == "s, above 0, at most 3600"
    assert in_words(at(experiment_schema(), ("plant", "environment", "kind"))) == "one of free, plate, crate"
    assert in_words(at(experiment_schema(), ("controller", "acting", "rotate"))) == "true or false"
    assert in_words(at(experiment_schema(), ("reference", "duration_s"))) == "s, at least 0, at most 3600"
    assert in_words(at(experiment_schema(), ("nowhere",))) == ""


@pytest.mark.parametrize("name", ["fig-4-25", "fig-5-5", "robust-sine", "adaptive-offset"])
def test_the_commented_file_reads_back_as_the_experiment(tmp_path: Path, name: str):
    path = tmp_path / "commented.toml"
    path.write_text(commented_toml(find(name)))
    assert load(path) == find(name)


def test_every_number_of_the_sections_has_a_comment():
    lines = commented_toml(find("fig-4-25")).split("[[reference]]")[0].splitlines()
    numbers = [line for line in lines if re.search(r" = -?\d", line)]
    assert len(numbers) > 100
    assert not [line for line in numbers if "#" not in line]
