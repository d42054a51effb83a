"""The fault test as a JUnit file: a suite a row, a case a way, so that any CI shows which faults were not survived."""

from junitparser import Failure, JUnitXml, Skipped, TestCase, TestSuite

from hydrohil.faulttest.report import Report, first_failure, milliseconds
from hydrohil.faulttest.tally import FAILED, NOT_TRIED, WayResult
from hydrohil.reproduction.junit import text


def junit(report: Report) -> str:
    """The file's text."""
    xml = JUnitXml("hydrohil faults")
    for result in report.results:
        suite = TestSuite(f"{result.row.number}: {result.row.fault}")
        for name in ("source_version", "seed", "trials", "command"):
            suite.add_property(name, str(getattr(report, name)))
        suite.add_testcases([_case(tried, result.row.number) for tried in result.tried])
        xml.add_testsuite(suite)
    return text(xml)


def _case(tried: WayResult, number: str) -> TestCase:
    case = TestCase(f"{tried.way.letter}: {tried.way.words}", f"faults.{number}")
    case.system_out = "\n".join(
        f"{'held' if trial.held else 'FAILED'}; {milliseconds(trial.reaction_s)} ms, bound {milliseconds(trial.bound_s)}; "
        f"{trial.words}"
        for trial in tried.trials
    )
    if tried.verdict == NOT_TRIED:
        case.result = [Skipped(tried.why)]
    elif tried.verdict == FAILED:
        case.result = [Failure(f"held in {tried.held} of {len(tried.trials)}: {first_failure(tried)}", "fault")]
    return case
