"""Tests that prove a property, run by pytest in a process of its own and read back as trials."""

import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

from junitparser import JUnitXml, Skipped

from battery.trial import Trial

ROOT = Path(__file__).resolve().parent.parent
NO_TESTS = "the tests are not beside the sources: run it in a clone"


class ProofsError(Exception):
    """pytest ran no tests; the message is its last line."""


def prove(tests: Iterable[str]) -> dict[str, tuple[Trial, ...]]:
    """Each node id with the trials that it stands for: one a case of a parametrised test. Raises ProofsError."""
    wanted = tuple(dict.fromkeys(tests))
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "proofs.xml"
        line = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", f"--junitxml={report}", *wanted]
        done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=False)
        if not report.is_file() or done.returncode not in (0, 1):
            raise ProofsError((done.stdout + done.stderr).strip().splitlines()[-1])
        return {test: trials_of(test, JUnitXml.fromfile(str(report))) for test in wanted}


def trials_of(test: str, report: JUnitXml) -> tuple[Trial, ...]:
    """The cases of one node id; without any it has not held."""
    path, *classes, name = test.split("::")
    place = ".".join((path.removesuffix(".py").replace("/", "."), *classes))
    found = []
    for suite in report:
        for case in suite:
            if case.classname == place and case.name.split("[")[0] == name and not isinstance(_first(case.result), Skipped):
                failure = _first(case.result)
                found.append(Trial(failure is None, f"{case.name}: {getattr(failure, 'message', None) or 'passed'}"))
    return tuple(found) or (Trial(False, f"{name}: no such test was run"),)


def _first(results: list[object]) -> object | None:
    return results[0] if results else None
