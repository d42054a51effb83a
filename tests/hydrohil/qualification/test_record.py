"""The record of a host: which trials are kept, and what is quoted of them."""

import json
import math

import pytest

from hydrohil.qualification.grading import judge
from hydrohil.qualification.record import RateTrial, finite, keep
from hydrohil.qualification.spread import Spread
from hydrohil.shared.host import qualified
from hydrohil.shared.host.qualified import Host, Qualified, record_file, standing
from tests.support.qualification_scene import GOOD, PERIOD_NS

HERE = Host("bench", "boot-1", "6.1", "Xeon", 4)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.setenv("HYDROHIL_CACHE", str(tmp_path))
    monkeypatch.setattr(qualified, "this_host", lambda: HERE)


def trial(measured_at="2026-11-28 02:00:00+00:00", **changes):
    figures = GOOD._replace(**changes)
    return RateTrial(figures, judge(figures), measured_at)


def kept(*trials, host=HERE):
    return keep(record_file(HERE, fifo=True), host, trials)


def test_what_is_kept_is_what_arming_reads():
    found = kept(trial(period_ns=2_000_000, ended="tripped"), trial(unanswered=2.0))
    assert found == standing(fifo=True).qualified
    assert found == Qualified(
        qualified_period_ns=PERIOD_NS,
        grade="B",
        measured_at="2026-11-28 02:00:00+00:00",
        period_ns=PERIOD_NS,
        samples=4000,
        late_share=0.0005,
        accepted_p999_us=300.0,
        wake_up_max_us=400.0,
        lease_ms=20.0,
    )


def test_where_no_rate_is_qualified_the_lowest_tried_is_quoted():
    found = kept(trial(period_ns=2_000_000, ended="tripped"), trial(ended="gap", accepted_us=Spread()))
    assert (found.qualified_period_ns, found.grade, found.period_ns, found.accepted_p999_us) == (0, "D", PERIOD_NS, None)
    assert standing(fifo=True).qualified == found


def test_a_rate_tried_again_replaces_its_trial_and_leaves_the_others():
    kept(trial(period_ns=2_000_000, ended="tripped"), trial())
    assert kept(trial(period_ns=2_000_000, measured_at="later")).qualified_period_ns == 2_000_000
    assert kept(trial(measured_at="later still", ended="tripped")).qualified_period_ns == 0
    trials = json.loads(record_file(HERE, fifo=True).read_text())["trials"]
    assert {one["period_ns"]: one["measured_at"] for one in trials} == {2_000_000: "later", PERIOD_NS: "later still"}


def test_a_trial_too_short_to_say_anything_is_not_kept_and_removes_nothing():
    assert kept(trial(samples=999)) is None
    assert not record_file(HERE, fifo=True).exists()
    before = kept(trial())
    assert kept(trial(samples=999)) == before


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"trials": 3}', '{"trials": [{"period_ns": 1}]}'])
def test_a_damaged_record_is_written_anew(text):
    path = record_file(HERE, fifo=True)
    path.parent.mkdir(parents=True)
    path.write_text(text)
    assert kept(trial()) == standing(fifo=True).qualified
    assert len(json.loads(path.read_text())["trials"]) == 1


def test_trials_of_another_boot_are_not_carried_over():
    kept(trial(period_ns=2_000_000), host=HERE._replace(boot_id="boot-0"))
    assert kept(trial()).qualified_period_ns == PERIOD_NS


def test_nothing_but_the_record_is_left_in_the_folder(tmp_path):
    kept(trial())
    assert list((tmp_path / "qualifications").iterdir()) == [record_file(HERE, fifo=True)]


def test_numbers_that_are_none_are_null():
    assert finite({"a": math.nan, "b": (1.0, math.inf), "c": "x", "d": 3}) == {"a": None, "b": [1.0, None], "c": "x", "d": 3}
