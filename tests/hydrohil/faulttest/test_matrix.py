import ast
from pathlib import Path

import pytest

from hydrohil.faulttest.matrix import MATRIX, UnknownRowError, find_rows
from hydrohil.faulttest.trial import ByTests, NotTried, Simulated
from hydrohil.shared.errors import HydrohilError

ROOT = Path(__file__).resolve().parents[3]
NUMBERS = [*map(str, range(1, 6)), "5b", *map(str, range(6, 28)), "27b", *map(str, range(28, 35))]
LEFT_OUT = ("17", "20", "22", "23", "26", "27")  # a second each once the local clock is compiled


def names(path: str) -> set[str]:
    return {node.name for node in ast.walk(ast.parse((ROOT / path).read_text())) if isinstance(node, ast.FunctionDef)}


def test_every_fault_has_one_row_and_the_rows_stand_in_order():
    assert [row.number for row in MATRIX] == NUMBERS


def test_every_row_is_tried_or_says_why_not():
    for row in MATRIX:
        assert row.ways and all(way.words for way in row.ways), row.number
        assert row.must and row.bound


def test_every_test_that_proves_a_row_exists():
    for row in MATRIX:
        for way in row.ways:
            for test in way.tests if isinstance(way, ByTests) else ():
                path, name = test.split("::")
                assert name in names(path), f"row {row.number}: {test}"


def test_no_two_ways_of_a_row_are_called_the_same():
    for row in MATRIX:
        titles = [(way.letter, way.words) for way in row.ways]
        assert len(set(titles)) == len(titles), row.number


def test_rows_are_found_by_number_in_their_order_and_an_unknown_one_is_named():
    assert [row.number for row in find_rows(["20", "5b", "1"])] == ["1", "5b", "20"]
    assert find_rows([]) == MATRIX
    with pytest.raises(UnknownRowError, match=r"99.*expected one of 1, 2") as caught:
        find_rows(["1", "99"])
    assert isinstance(caught.value, HydrohilError)


def test_what_is_not_tried_is_never_called_a_trial():
    assert not [way for row in MATRIX for way in row.ways if isinstance(way, NotTried) and way.letter != "-"]


@pytest.mark.parametrize("number", LEFT_OUT)
def test_faults_of_the_machine_are_survived_to_the_tick(number: str):
    for way in find_rows([number])[0].ways:
        if isinstance(way, Simulated):
            trial = way.trial(0)
            assert trial.held, f"{way.words}: {trial.words}"
