import json
import math

import pytest
from junitparser import JUnitXml

from hydrohil.faulttest.junit import junit
from hydrohil.faulttest.page import histogram, page
from hydrohil.faulttest.report import Report, to_json
from hydrohil.faulttest.tally import FAILED, HELD, UNTRIED, Result, Tried, counts, of_all
from hydrohil.faulttest.trial import Lived, Proved, Row, Trial, Untried

WAY = Lived("SIGKILL <live>", lambda rig, dice, number: GOOD)
GOOD = Trial(True, "zero current", 0.020, 0.0245, 0.0, 1.5, 3.0, (("sample to command", 0.4),))
LATE = GOOD._replace(held=False, words="too late", reaction_s=0.030)
PROOF = Proved("a test", ("tests/test_x.py::test_y",))
ROW = Row("1", "controller killed", "safe", "lease + T", (WAY, PROOF, Untried("there is no router")))


def report(*tried: Tried) -> Report:
    return Report((Result(ROW, tried),), 5, 0, 20.0, False, "abc", "2026-01-01", 12.0, "a machine", "hydrohil faults", ())


def test_one_trial_that_fails_fails_its_way_its_row_and_the_build():
    failed = report(Tried(WAY, (GOOD, LATE)), Tried(PROOF, (GOOD,)))
    assert failed.results[0].verdict == FAILED
    assert failed.exit_status == 1
    assert report(Tried(WAY, (GOOD, GOOD))).exit_status == 0


def test_what_was_not_tried_is_not_counted_as_survived():
    untried = report(Tried(ROW.ways[2], (), "there is no router"))
    assert untried.results[0].verdict == UNTRIED
    assert untried.headline == "0 of 1 faults survived, 1 not tried"
    assert counts(untried.results)[HELD] == 0
    assert of_all([HELD, UNTRIED]) == HELD


@pytest.mark.parametrize(
    ("reaction_s", "stalled_s", "in_time"),
    [(0.0245, 0.0, True), (0.0246, 0.0, False), (0.0346, 0.0101, True), (math.nan, 0.0, False)],
)
def test_a_reaction_may_take_its_bound_and_what_the_host_stood_still_and_no_more(reaction_s, stalled_s, in_time):
    assert GOOD._replace(reaction_s=reaction_s, stalled_s=stalled_s).in_time == in_time


def test_worst_and_median_are_over_the_trials_that_know_them():
    tried = Tried(WAY, (GOOD, LATE, GOOD._replace(reaction_s=math.nan)))
    assert tried.worst("reaction_s") == 0.030
    assert tried.middle("reaction_s") == pytest.approx(0.025)
    assert tried.hops == (("sample to command", 0.4, 0.4),)
    assert math.isnan(Tried(WAY, ()).worst("reaction_s"))


def test_the_junit_file_shows_failures_and_what_was_skipped():
    told = report(Tried(WAY, (GOOD, LATE)), Tried(PROOF, (GOOD,)), Tried(ROW.ways[2], (), "there is no router"))
    xml = JUnitXml.fromstring(junit(told).encode())
    assert (xml.tests, xml.failures, xml.skipped) == (3, 1, 1)
    assert "too late" in junit(told)


def test_the_page_is_whole_escaped_and_loads_nothing():
    text = page(report(Tried(WAY, (GOOD, LATE, GOOD)), Tried(ROW.ways[2], (), "there is no router")))
    assert "0 of 1 faults survived, 1 NOT" in text
    assert "SIGKILL &lt;live&gt;" in text and "<svg" in text and "there is no router" in text
    assert "<script" not in text and "http://" not in text.replace("http://www.w3.org", "")


def test_a_histogram_needs_a_bound_and_three_reactions():
    assert not histogram(Tried(WAY, (GOOD, GOOD)), "key")
    assert not histogram(Tried(WAY, (GOOD._replace(bound_s=math.nan),) * 3), "key")
    assert histogram(Tried(WAY, (GOOD,) * 3), "key").startswith("<svg")


def test_a_machine_reads_every_number_and_null_for_what_there_is_not():
    told = json.loads(to_json(report(Tried(WAY, (GOOD._replace(reaction_s=math.nan),)))))
    trial = told["rows"][0]["ways"][0]["trials"][0]
    assert trial["reaction_s"] is None and trial["moved_mm"] == 1.5 and trial["hops"] == {"sample to command": 0.4}
