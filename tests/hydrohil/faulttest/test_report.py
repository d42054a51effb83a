import json
import math

import pytest
from junitparser import JUnitXml

from hydrohil.faulttest.junit import junit
from hydrohil.faulttest.page import histogram, page
from hydrohil.faulttest.report import Report, to_json
from hydrohil.faulttest.tally import FAILED, HELD, NOT_TRIED, RowResult, WayResult, counts, of_all
from hydrohil.faulttest.trial import ByTests, Live, NotTried, Row, Trial

WAY = Live("SIGKILL <live>", lambda rig, rng, number: GOOD)
GOOD = Trial(
    held=True,
    words="zero current",
    reaction_s=0.020,
    bound_s=0.0245,
    stalled_s=0.0,
    moved_mm=1.5,
    force_n=3.0,
    hops=(("sample to command", 0.4),),
)
LATE = GOOD._replace(held=False, words="too late", reaction_s=0.030)
PROOF = ByTests("a test", ("tests/test_x.py::test_y",))
ROW = Row(
    number="1", fault="controller killed", must="safe", bound="lease + T", ways=(WAY, PROOF, NotTried("there is no router"))
)


def report(*tried: WayResult) -> Report:
    return Report(
        results=(RowResult(ROW, tried),),
        trials=5,
        seed=0,
        lease_ms=20.0,
        interrupted=False,
        source_version="abc",
        created_at="2026-01-01",
        duration_s=12.0,
        machine="a machine",
        command="hydrohil faults",
        restarted=(),
    )


def test_one_trial_that_fails_fails_its_way_its_row_and_the_build():
    failed = report(WayResult(WAY, (GOOD, LATE)), WayResult(PROOF, (GOOD,)))
    assert failed.results[0].verdict == FAILED
    assert failed.exit_status == 1
    assert report(WayResult(WAY, (GOOD, GOOD))).exit_status == 0


def test_what_was_not_tried_is_not_counted_as_survived():
    untried = report(WayResult(ROW.ways[2], (), "there is no router"))
    assert untried.results[0].verdict == NOT_TRIED
    assert untried.headline == "0 of 1 faults survived, 1 not tried"
    assert counts(untried.results)[HELD] == 0
    assert of_all([HELD, NOT_TRIED]) == HELD


@pytest.mark.parametrize(
    ("reaction_s", "stalled_s", "in_time"),
    [(0.0245, 0.0, True), (0.0246, 0.0, False), (0.0346, 0.0101, True), (math.nan, 0.0, False)],
)
def test_a_reaction_may_take_its_bound_and_what_the_host_stood_still_and_no_more(reaction_s, stalled_s, in_time):
    assert GOOD._replace(reaction_s=reaction_s, stalled_s=stalled_s).in_time == in_time


def test_worst_and_median_are_over_the_trials_that_know_them():
    tried = WayResult(WAY, (GOOD, LATE, GOOD._replace(reaction_s=math.nan)))
    assert tried.worst("reaction_s") == 0.030
    assert tried.middle("reaction_s") == pytest.approx(0.025)
    assert tried.hops == (("sample to command", 0.4, 0.4),)
    assert math.isnan(WayResult(WAY, ()).worst("reaction_s"))


def test_the_junit_file_shows_failures_and_what_was_skipped():
    found = report(WayResult(WAY, (GOOD, LATE)), WayResult(PROOF, (GOOD,)), WayResult(ROW.ways[2], (), "there is no router"))
    xml = JUnitXml.fromstring(junit(found).encode())
    assert (xml.tests, xml.failures, xml.skipped) == (3, 1, 1)
    assert "too late" in junit(found)


def test_the_page_is_whole_escaped_and_loads_nothing():
    text = page(report(WayResult(WAY, (GOOD, LATE, GOOD)), WayResult(ROW.ways[2], (), "there is no router")))
    assert "0 of 1 faults survived, 1 NOT" in text
    assert "SIGKILL &lt;live&gt;" in text and "<svg" in text and "there is no router" in text
    assert "<script" not in text and "http://" not in text.replace("http://www.w3.org", "")


def test_a_histogram_needs_a_bound_and_three_reactions():
    assert not histogram(WayResult(WAY, (GOOD, GOOD)), "key")
    assert not histogram(WayResult(WAY, (GOOD._replace(bound_s=math.nan),) * 3), "key")
    assert histogram(WayResult(WAY, (GOOD,) * 3), "key").startswith("<svg")


def test_a_machine_reads_every_number_and_null_for_what_there_is_not():
    found = json.loads(to_json(report(WayResult(WAY, (GOOD._replace(reaction_s=math.nan),)))))
    trial = found["rows"][0]["ways"][0]["trials"][0]
    assert trial["reaction_s"] is None and trial["moved_mm"] == 1.5 and trial["hops"] == {"sample to command": 0.4}
