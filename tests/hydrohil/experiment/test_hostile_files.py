"""Files that a hostile or clumsy user writes: each is one clear line, or is read as it was meant."""

from pathlib import Path

import pytest

import hydrohil as hh
from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.plain_data import DEEPEST, too_deep, unprintable

BASE = 'base = "fig-5-5"\n'


def refused(path: Path) -> str:
    with pytest.raises(ExperimentError) as error:
        hh.load(path)
    (line,) = error.value.problems
    return line


def written(folder: Path, text: str, name: str = "mine.toml") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def test_a_byte_order_mark_is_no_part_of_the_file(tmp_path: Path):
    path = tmp_path / "mine.toml"
    path.write_bytes(b"\xef\xbb\xbf" + BASE.encode())
    assert hh.load(path).name == "mine"


def test_a_base_that_is_a_link_to_itself_cannot_be_read(tmp_path: Path):
    (tmp_path / "loop.toml").symlink_to("loop.toml")
    assert "loop.toml: cannot be read (" in refused(written(tmp_path, 'base = "loop.toml"\n'))


def test_a_chain_of_files_that_is_too_long_does_not_claim_to_be_a_circle(tmp_path: Path):
    for number in range(20):
        written(tmp_path, f'base = "{number + 1}.toml"\n', f"{number}.toml")
    assert "is more than 8 files deep" in refused(tmp_path / "0.toml")


def test_an_integer_of_more_digits_than_python_reads_is_refused(tmp_path: Path):
    assert "is no TOML" in refused(written(tmp_path, f"{BASE}duration_s = 1{'0' * 6000}\n"))


@pytest.mark.parametrize("depth", [300, 5000])
def test_tables_are_not_nested_without_end(tmp_path: Path, depth: int):
    line = refused(written(tmp_path, f"{BASE}[plant.machine.{'.'.join('a' * depth)}]\nx = 1\n"))
    assert "nested more than" in line and len(line) < 300


def test_depth_is_counted_without_recursion():
    deep: list[object] = []
    for _ in range(DEEPEST - 1):
        deep = [deep]
    assert not too_deep(deep)
    assert too_deep([[deep]]) and too_deep({"a": {"b": (deep,)}})


@pytest.mark.parametrize("letter", ["\x1b", "\x07", "\n", "\x9b", "\u202e", "\u2028", "\x00"])
@pytest.mark.parametrize("field", ["title", "source"])
def test_a_text_that_a_terminal_would_obey_is_refused(field: str, letter: str):
    with pytest.raises(ExperimentError, match=rf"{field} has the character U\+{ord(letter):04X}"):
        hh.load("fig-5-5").with_values({field: f"a{letter}b"})


def test_text_of_any_language_prints():
    assert not list(unprintable({"title": "Kraft 5\u202fkN, élève, 力, [/]"}))


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"plant.machine_name": "puma"}, "plant.machine_name is 'puma'; expected one of unimate"),
        ({"plant.machine.supply_pressure_pa": 34e6}, "supply_pressure_pa is 34 MPa; expected 6.5..7.5 MPa"),
        ({"plant.machine.a4_m": 1e300}, "hand_m is 1e+300 m; expected -100..100"),
        ({"plant.machine.force_high_n": -5.0}, "gauge.range_n is -5 N"),
    ],
)
def test_a_machine_that_no_plant_would_describe_is_refused_before_it_runs(values: dict[str, object], line: str):
    with pytest.raises(ExperimentError, match="expected") as error:
        hh.load("fig-5-5").with_values(values)
    assert line in str(error.value)


@pytest.mark.parametrize("seed", [-1, 1.5, True, None, "1", float("nan"), 1 << 64])
def test_a_seed_is_a_whole_number(seed: object):
    with pytest.raises(ExperimentError, match=r"seed is .*expected a whole number from 0"):
        hh.simulate(hh.load("fig-4-25"), seed=seed)  # type: ignore[arg-type]


@pytest.mark.parametrize("wrong", [None, 3, b"fig-5-5", []])
def test_what_is_no_experiment_is_named(wrong: object):
    for take in (hh.load, hh.simulate, hh.validate):
        with pytest.raises(ExperimentError, match=f"not {type(wrong).__name__}"):
            take(wrong)  # type: ignore[operator]


@pytest.mark.parametrize("wrong", [None, [1], {3: 1}])
def test_values_are_named_by_paths(wrong: object):
    with pytest.raises(ExperimentError, match="expected a dict of values by their paths"):
        hh.load("fig-5-5").with_values(wrong)  # type: ignore[arg-type]
