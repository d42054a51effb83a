"""Tests that prove a row, read back as trials: cases, failures, and tests that a machine cannot run."""

from pathlib import Path

import pytest
from junitparser import JUnitXml

from hydrohil.faulttest import row_tests
from hydrohil.faulttest.execution import LEFT_OUT, Execution, Settings, total
from hydrohil.faulttest.row_tests import NodeOutcome, combined, outcome_of, run_row_tests
from hydrohil.faulttest.tally import HELD, NOT_TRIED
from hydrohil.faulttest.trial import ByTests, Row, Trial

GOOD, BAD = Trial(True, "passed"), Trial(False, "failed")
SLOW = """
import pytest

@pytest.mark.slow
@pytest.mark.parametrize("case", [1, 2])
def test_slow(case):
    assert case > 0

@pytest.mark.skipif(True, reason="no namespaces here")
def test_impossible():
    raise AssertionError
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project of its own, in which slow tests are left out unless they are asked for."""
    (tmp_path / "pyproject.toml").write_text("[tool.pytest.ini_options]\naddopts = \"-m 'not slow'\"\nmarkers = ['slow']\n")
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_x.py").write_text(SLOW)
    monkeypatch.setattr(row_tests, "ROOT", tmp_path)
    monkeypatch.setattr("hydrohil.faulttest.execution.ROOT", tmp_path)
    return tmp_path


def test_a_slow_test_that_is_named_is_run_and_one_that_is_skipped_says_why(folder: Path):
    found = run_row_tests(("tests/test_x.py::test_slow", "tests/test_x.py::test_impossible"))
    slow, impossible = found.values()
    assert [trial.held for trial in slow.trials] == [True, True] and not slow.skipped
    assert impossible.trials == () and "no namespaces here" in impossible.skipped


def test_a_test_that_was_not_run_has_not_held():
    (trial,) = outcome_of("tests/test_x.py::test_gone", JUnitXml()).trials
    assert not trial.held and "no such test" in trial.words


def test_what_is_skipped_leaves_a_way_untried_unless_another_test_fails():
    skipped = NodeOutcome((), "no namespaces here")
    assert combined((NodeOutcome((GOOD,)), NodeOutcome((GOOD,)))) == NodeOutcome((GOOD, GOOD))
    assert combined((NodeOutcome((GOOD,)), skipped)) == NodeOutcome((), "no namespaces here")
    assert combined((NodeOutcome((BAD,)), skipped)) == NodeOutcome((BAD,))


def row(name: str, letter: str = "P") -> Row:
    return Row(
        number="8",
        fault="partition",
        must="safe",
        bound="lease",
        ways=(ByTests("by a test", (f"tests/test_x.py::{name}",), letter),),
    )


def played(one: Row, *, quick: bool = False) -> tuple[str, str]:
    """Verdict, and why there is none."""
    execution = Execution((one,), {}, Settings(1, 0, quick), lambda *_: None)
    execution.play()
    (result,) = execution.results()
    return result.verdict, result.tried[0].why


def test_a_row_whose_test_the_machine_cannot_run_is_not_survived_and_says_why(folder: Path):
    verdict, why = played(row("test_impossible"))
    assert verdict == NOT_TRIED and "no namespaces here" in why


def test_tests_with_real_processes_are_left_out_of_the_quick_fault_test(folder: Path):
    assert played(row("test_slow", "W"), quick=True) == (NOT_TRIED, LEFT_OUT)
    assert played(row("test_slow", "W")) == (HELD, "")
    assert played(row("test_slow"), quick=True) == (HELD, "")


@pytest.mark.parametrize(("name", "letter", "quick", "steps"), [("test_slow", "P", False, 1), ("test_slow", "W", True, 0)])
def test_a_bar_takes_one_step_for_the_tests_of_a_way_whatever_their_cases(folder: Path, name, letter, quick, steps):
    reported, settings = [], Settings(1, 0, quick)
    one = row(name, letter)
    Execution((one,), {}, settings, lambda title, trial: reported.append((title, trial))).play()
    assert total((one,), settings) == steps
    assert [(title, trial.held) for title, trial in reported if trial is not None] == [(f"8 {letter} by a test", True)] * steps


def test_every_case_that_fails_is_named_in_one_step(folder: Path):
    (folder / "tests" / "test_x.py").write_text(
        "import pytest\n\n@pytest.mark.parametrize('n', [1, 2, 3])\ndef test_n(n):\n    assert n > 2\n"
    )
    reported = []
    Execution((row("test_n"),), {}, Settings(1, 0, quick=False), lambda _, trial: reported.append(trial)).play()
    (trial,) = [trial for trial in reported if trial is not None]
    assert not trial.held and "test_n[1]" in trial.words and "test_n[2]" in trial.words and "test_n[3]" not in trial.words
