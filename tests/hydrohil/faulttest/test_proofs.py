"""Tests read back as trials: cases, failures, and what a machine does not permit."""

from pathlib import Path

import pytest
from junitparser import JUnitXml

from hydrohil.faulttest import proofs
from hydrohil.faulttest.proofs import Proof, proof_of, prove, together
from hydrohil.faulttest.run import QUICK, FaultTest, Wish, total
from hydrohil.faulttest.tally import HELD, UNTRIED
from hydrohil.faulttest.trial import Proved, Row, Trial

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
    monkeypatch.setattr(proofs, "ROOT", tmp_path)
    monkeypatch.setattr("hydrohil.faulttest.run.ROOT", tmp_path)
    return tmp_path


def test_a_slow_test_that_is_named_is_run_and_one_that_is_skipped_says_why(folder: Path):
    found = prove(("tests/test_x.py::test_slow", "tests/test_x.py::test_impossible"))
    slow, impossible = found.values()
    assert [trial.held for trial in slow.trials] == [True, True] and not slow.skipped
    assert impossible.trials == () and "no namespaces here" in impossible.skipped


def test_a_test_that_was_not_run_has_not_held():
    (trial,) = proof_of("tests/test_x.py::test_gone", JUnitXml()).trials
    assert not trial.held and "no such test" in trial.words


def test_what_is_skipped_leaves_a_way_untried_unless_another_test_fails():
    skipped = Proof((), "no namespaces here")
    assert together((Proof((GOOD,)), Proof((GOOD,)))) == Proof((GOOD, GOOD))
    assert together((Proof((GOOD,)), skipped)) == Proof((), "no namespaces here")
    assert together((Proof((BAD,)), skipped)) == Proof((BAD,))


def row(name: str, letter: str = "P") -> Row:
    return Row("8", "partition", "safe", "lease", (Proved("a proof", (f"tests/test_x.py::{name}",), letter),))


def played(one: Row, *, quick: bool = False) -> tuple[str, str]:
    """Verdict, and why there is none."""
    battery = FaultTest((one,), {}, Wish(1, 0, quick), lambda *_: None)
    battery.play()
    (result,) = battery.results()
    return result.verdict, result.tried[0].why


def test_a_row_whose_proof_the_machine_does_not_permit_is_not_survived_and_says_why(folder: Path):
    verdict, why = played(row("test_impossible"))
    assert verdict == UNTRIED and "no namespaces here" in why


def test_proofs_by_real_processes_are_left_out_of_the_quick_battery(folder: Path):
    assert played(row("test_slow", "W"), quick=True) == (UNTRIED, QUICK)
    assert played(row("test_slow", "W")) == (HELD, "")
    assert played(row("test_slow"), quick=True) == (HELD, "")


@pytest.mark.parametrize(("name", "letter", "quick", "steps"), [("test_slow", "P", False, 1), ("test_slow", "W", True, 0)])
def test_a_bar_takes_one_step_for_the_tests_of_a_way_whatever_their_cases(folder: Path, name, letter, quick, steps):
    told, wish = [], Wish(1, 0, quick)
    one = row(name, letter)
    FaultTest((one,), {}, wish, lambda title, trial: told.append((title, trial))).play()
    assert total((one,), wish) == steps
    assert [(title, trial.held) for title, trial in told if trial is not None] == [(f"8 {letter} a proof", True)] * steps


def test_every_case_that_fails_is_named_in_one_step(folder: Path):
    (folder / "tests" / "test_x.py").write_text(
        "import pytest\n\n@pytest.mark.parametrize('n', [1, 2, 3])\ndef test_n(n):\n    assert n > 2\n"
    )
    told = []
    FaultTest((row("test_n"),), {}, Wish(1, 0, quick=False), lambda _, trial: told.append(trial)).play()
    (trial,) = [trial for trial in told if trial is not None]
    assert not trial.held and "test_n[1]" in trial.words and "test_n[2]" in trial.words and "test_n[3]" not in trial.words
