"""The verdicts as a JUnit file: a suite a chapter, a case a claim, so that any CI shows them."""

import io

from junitparser import Error, Failure, JUnitXml, TestCase, TestSuite

from hydrohil.claims.claims import band
from hydrohil.reproduction.formatting import measured, verdict
from hydrohil.reproduction.plan import CHAPTERS
from hydrohil.reproduction.report import Report
from hydrohil.reproduction.tally import Result, Tally, failures


def junit(report: Report) -> str:
    """The file's text; a failure says what was stated, what was measured, the source and the best explanation."""
    xml = JUnitXml("hydrohil reproduce")
    why = {(failure.figure.name, failure.tally.claim.statement): failure.why for failure in failures(report.results)}
    for chapter in report.counts:
        suite = TestSuite(chapter.title)
        suite.add_property("source_version", report.source_version)
        suite.add_property("seeds", str(report.seeds))
        suite.add_property("clock", report.clock)
        for result in report.results:
            if CHAPTERS[result.figure.chapter] == chapter.title:
                suite.add_testcases([_case(result, one, why) for one in result.tallies])
        xml.add_testsuite(suite)
    return text(xml)


def text(xml: JUnitXml) -> str:
    """The file's text, with its sums."""
    xml.update_statistics()
    file = io.BytesIO()
    xml.write(file, pretty=True)
    return file.getvalue().decode()


def _case(result: Result, one: Tally, why: dict[tuple[str, str], str]) -> TestCase:
    case = TestCase(one.claim.statement, result.figure.name)
    case.system_out = f"stated {band(one.claim)}; measured {measured(one)}; {verdict(one)}"
    if one.holds:
        return case
    reason = why[result.figure.name, one.claim.statement] or "unexplained"
    text = f"stated: {band(one.claim)}\nmeasured: {measured(one)}\nsource: {one.claim.source}\nexplanation: {reason}"
    if result.tripped or result.gaps:
        case.result = [Error("; ".join((*result.tripped, *result.gaps)), "no verdict")]
    else:
        case.result = [Failure(f"{verdict(one)}: stated {band(one.claim)}, measured {measured(one)}", "claim")]
    case.result[0].text = text
    return case
