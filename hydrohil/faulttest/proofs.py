"""Tests that prove a property, run by pytest in a process of its own and read back as trials."""

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


class ProofsError(HydrohilError):
    """pytest ran no tests; the message is its last line."""


class Proof(NamedTuple):
    """What one node id showed."""

    trials: tuple[Trial, ...]  # one a case of a parametrised test
    skipped: str = ""  # why a case was skipped, by pytest's own word


def prove(tests: Iterable[str]) -> dict[str, Proof]:
    """What each node id showed, whatever its marks. Raises ProofsError."""
    wanted = tuple(dict.fromkeys(tests))
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "proofs.xml"
        line = [*python_module("pytest"), "-q", "-p", "no:cacheprovider", "-m", "", f"--junitxml={report}", *wanted]
        done = subprocess.run(line, cwd=ROOT, env=environment(), capture_output=True, text=True, check=False)
        if not report.is_file() or done.returncode not in (0, 1):
            raise ProofsError((done.stdout + done.stderr).strip().splitlines()[-1])
        return {test: proof_of(test, JUnitXml.fromfile(str(report))) for test in wanted}


def proof_of(test: str, report: JUnitXml) -> Proof:
    """The cases of one node id; without any it has not held."""
    path, *classes, name = test.split("::")
    place = ".".join((path.removesuffix(".py").replace("/", "."), *classes))
    found, skipped = [], ""
    for suite in report:
        for case in suite:
            if case.classname != place or case.name.split("[")[0] != name:
                continue
            result = case.result[0] if case.result else None
            if isinstance(result, Skipped):
                skipped = str(result.message)
            else:
                found.append(Trial(result is None, f"{case.name}: {getattr(result, 'message', None) or 'passed'}"))
    if not found and not skipped:
        return Proof((Trial(False, f"{name}: no such test was run"),))
    return Proof(tuple(found), skipped)


def together(proofs: Iterable[Proof]) -> Proof:
    """Several tests of one way: what was skipped leaves the way untried, unless a test has failed."""
    known = tuple(proofs)
    trials = tuple(trial for proof in known for trial in proof.trials)
    skipped = next((proof.skipped for proof in known if proof.skipped), "")
    return Proof((), skipped) if skipped and all(trial.held for trial in trials) else Proof(trials)
