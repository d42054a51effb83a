"""A short file: a base and what differs. Everything else as the base has it, or by default."""

from pathlib import Path

import pytest

from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import Experiment, to_plain
from hydrohil.experiment.sections import UNIMATE_PARAMS, PlantConfig
from hydrohil.thesis.library import find, load

TEN_LINES = """
base = "fig-5-5"
duration_s = 25.0

[controller.gains.down_up]
kp_a_per_rad = 9.0

[plant.machine]
a4_m = 0.55
"""


def written(folder: Path, text: str, name: str = "mine.toml") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def refused(path: Path) -> str:
    with pytest.raises(ExperimentError) as error:
        load(path)
    (line,) = error.value.problems
    return line


def test_a_file_of_ten_lines_changes_its_base_and_nothing_else(tmp_path: Path):
    mine, base = load(written(tmp_path, TEN_LINES)), find("fig-5-5")
    assert (mine.name, mine.alias, mine.title, mine.source) == ("mine", "mine", "mine", "mine.toml, on fig-5-5")
    assert mine.duration_s == 25.0 and mine.plant.machine.a4_m == 0.55
    assert mine.controller.gains.down_up == base.controller.gains.down_up._replace(kp_a_per_q=9.0)
    back = mine._replace(
        name=base.name, alias=base.alias, title=base.title, source=base.source, duration_s=base.duration_s
    ).with_values({"plant.machine.a4_m": 0.5, "controller.gains.down_up.kp_a_per_rad": base.controller.gains.down_up.kp_a_per_q})
    assert back == base


def test_one_value_of_the_machine_keeps_the_others(tmp_path: Path):
    mine = load(written(tmp_path, "duration_s = 1.0\n[plant.machine]\na4_m = 0.7\n"))
    assert mine.plant == PlantConfig(machine=UNIMATE_PARAMS._replace(a4_m=0.7))


def test_without_a_base_what_is_not_named_is_the_default(tmp_path: Path):
    mine = load(written(tmp_path, "duration_s = 1.0\n"))
    assert mine == Experiment(name="mine", alias="mine", title="mine", source="mine.toml", duration_s=1.0)


def test_a_base_may_be_a_file_beside_the_own_one(tmp_path: Path):
    written(tmp_path, TEN_LINES, "first.toml")
    second = load(written(tmp_path, 'base = "first.toml"\nduration_s = 26.0\n', "second.toml"))
    assert (second.duration_s, second.plant.machine.a4_m, second.source) == (26.0, 0.55, "second.toml, on first")


def test_files_that_are_each_others_base_are_refused(tmp_path: Path):
    one = written(tmp_path, 'base = "two.toml"\n', "one.toml")
    written(tmp_path, 'base = "one.toml"\n', "two.toml")
    assert "leads back" in refused(one)


def test_a_base_that_nobody_knows_names_the_nearest(tmp_path: Path):
    assert "fig-5-5" in refused(written(tmp_path, 'base = "fig-5-55"\n')) and "mine.toml" in refused(tmp_path / "mine.toml")


@pytest.mark.parametrize("base", ["5", "[1]", "true"])
def test_a_base_that_is_no_text_is_refused(tmp_path: Path, base: str):
    assert "expected the name of an experiment" in refused(written(tmp_path, f"base = {base}\n"))


def test_what_is_mistyped_in_a_short_file_is_still_named(tmp_path: Path):
    line = refused(written(tmp_path, 'base = "fig-5-5"\n[controller.gains.down_up]\nkp_a_per_m = 9.0\n'))
    assert "controller.gains.down_up.kp_a_per_m is no field" in line and "kp_a_per_rad" in line


def test_a_table_where_a_value_belongs_is_refused(tmp_path: Path):
    assert "duration_s" in refused(written(tmp_path, 'base = "fig-5-5"\n[duration_s]\nseconds = 1.0\n'))


def test_merging_leaves_the_base_as_it_was(tmp_path: Path):
    before = to_plain(find("fig-5-5"))
    load(written(tmp_path, TEN_LINES))
    assert to_plain(find("fig-5-5")) == before
