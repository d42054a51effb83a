from junitparser import Failure, JUnitXml

from hydrohil.reproduction.junit import junit
from tests.support.reproduction_scene import CLAIM, computed, report, trial


def cases(document):
    return [case for suite in JUnitXml.fromstring(junit(document).encode()) for case in suite]


def test_there_is_a_case_a_claim_of_the_class_of_its_figure():
    document = report(trial(19), computed())
    assert [(case.classname, case.name) for case in cases(document)] == [("fig-5-9", CLAIM.statement), ("fig-6-4", "a < b & c")]
    assert all(case.is_passed for case in cases(document))


def test_the_counts_are_those_of_the_report():
    document = report(trial(18), computed())
    xml = JUnitXml.fromstring(junit(document).encode())
    assert (xml.tests, xml.failures, xml.errors) == (document.total.claims, document.total.fail, 0)


def test_a_failure_says_what_was_stated_and_measured_and_the_source():
    (case,) = cases(report(trial(18)))
    (failure,) = case.result
    assert isinstance(failure, Failure)
    assert "below 160 N" in failure.text and "160 ± 0.03 N" in failure.text and CLAIM.source in failure.text
    assert "18 of 20" in failure.message


def test_a_trial_without_a_verdict_is_an_error_and_no_failure():
    xml = JUnitXml.fromstring(junit(report(trial(0, 1, tripped="too much"))).encode())
    assert (xml.failures, xml.errors) == (0, 1)
