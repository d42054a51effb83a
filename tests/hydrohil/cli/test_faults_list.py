"""`hydrohil faults --list` names every fault, its bound and how it is tried, and starts nothing."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from hydrohil.cli.main import app
from hydrohil.faulttest.matrix import MATRIX


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def faults(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["faults", "--list", *arguments])


def test_every_fault_is_listed_and_nothing_is_written(tmp_path: Path):
    run = faults()
    assert run.exit_code == 0, run.output
    numbers = [cells[1].strip() for line in run.stdout.splitlines() if len(cells := line.split("│")) > 2 and cells[1].strip()]
    assert numbers == [row.number for row in MATRIX]
    assert list(tmp_path.iterdir()) == []


def test_a_row_shows_its_bound_and_how_it_is_tried():
    (row,) = json.loads(faults("33", "--json", "-").stdout)
    assert (row["number"], row["bound"]) == ("33", "T + one hop")
    assert [way["letter"] for way in row["ways"]] == ["W", "W", "W"] and all(way["tried"] for way in row["ways"])
    untried = [way for row in json.loads(faults("--json", "-").stdout) for way in row["ways"] if not way["tried"]]
    assert untried and all(way["words"] for way in untried)


def test_the_list_goes_into_a_file(tmp_path: Path):
    assert faults("--only", "1", "28", "--json", "folder/list.json").exit_code == 0
    first, other = json.loads((tmp_path / "folder" / "list.json").read_text())
    assert (first["number"], other["number"]) == ("1", "28")
    assert any("tests/" in test for way in other["ways"] for test in way.get("tests", ()))


def test_an_unknown_number_is_one_line_and_2():
    run = faults("99z")
    assert run.exit_code == 2 and "99z" in run.stderr and len(run.stderr.splitlines()) == 1
