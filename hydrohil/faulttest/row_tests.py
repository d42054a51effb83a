"""Tests that prove a row, run by pytest in a process of its own and read back as trials."""

import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from junitparser import JUnitXml, Skipped

from hydrohil.faulttest.trial import Trial
from hydrohil.shared.errors import HydrohilError
from hydrohil.shared.host.child import environment, python_module

ROOT = Path(__file__).resolve().parent.parent.parent
NO_TESTS = "the tests are not beside the sources: run it in a clone"


class RowTestsError(HydrohilError):
    """pytest ran no tests; the message is its last line."""


class NodeOutcome(NamedTuple):
    """The cases of one node id, and why some were skipped."""

    trials: tuple[Trial, ...]  # one a case of a parametrised test
    skipped: str = ""  # why a case was skipped, by pytest's own word


def run_row_tests(tests: Iterable[str]) -> dict[str, NodeOutcome]:
    """The outcome of each node id, whatever its marks. Raises RowTestsError."""
    nodes = tuple(dict.fromkeys(tests))
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "row-tests.xml"
        line = [*python_module("pytest"), "-q", "-p", "no:cacheprovider", "-m", "", f"--junitxml={report}", *nodes]
        done = subprocess.run(line, cwd=ROOT, env=environment(), capture_output=True, text=True, check=False)
        if not report.is_file() or done.returncode not in (0, 1):
            raise RowTestsError((done.stdout + done.stderr).strip().splitlines()[-1])
        return {test: outcome_of(test, JUnitXml.fromfile(str(report))) for test in nodes}


def outcome_of(test: str, report: JUnitXml) -> NodeOutcome:
    """The cases of one node id; without any it has not held."""
    path, *classes, name = test.split("::")
    module = ".".join((path.removesuffix(".py").replace("/", "."), *classes))
    found, skipped = [], ""
    for suite in report:
        for case in suite:
            if case.classname != module or case.name.split("[")[0] != name:
                continue
            result = case.result[0] if case.result else None
            if isinstance(result, Skipped):
                skipped = str(result.message)
            else:
                found.append(Trial(result is None, f"{case.name}: {getattr(result, 'message', None) or 'passed'}"))
    if not found and not skipped:
        return NodeOutcome((Trial(False, f"{name}: no such test was run"),))
    return NodeOutcome(tuple(found), skipped)


def combined(outcomes: Iterable[NodeOutcome]) -> NodeOutcome:
    """Several tests of one way: what was skipped leaves the way untried, unless a test has failed."""
    known = tuple(outcomes)
    trials = tuple(trial for outcome in known for trial in outcome.trials)
    skipped = next((outcome.skipped for outcome in known if outcome.skipped), "")
    return NodeOutcome((), skipped) if skipped and all(trial.held for trial in trials) else NodeOutcome(trials)
