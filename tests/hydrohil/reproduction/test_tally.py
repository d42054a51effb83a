import math

import pytest

from hydrohil.claims.claims import verdict
from hydrohil.reproduction.plan import find_figure
from hydrohil.reproduction.play import Found
from hydrohil.reproduction.tally import counts, exit_status, failures, result, tally, total
from tests.support.reproduction_scene import CLAIM, computed, trial, verdicts


@pytest.mark.parametrize(("held", "seeds", "holds"), [(19, 20, True), (18, 20, False), (95, 100, True), (94, 100, False)])
def test_a_claim_holds_in_95_percent_of_the_seeds_and_not_in_fewer(held, seeds, holds):
    assert tally(verdicts(held, seeds)).holds is holds


@pytest.mark.parametrize("seeds", [1, 8, 19])
def test_of_fewer_than_twenty_seeds_it_must_hold_in_all(seeds):
    assert tally(verdicts(seeds, seeds)).holds
    assert not tally(verdicts(seeds - 1, seeds)).holds


def test_mean_and_spread_are_of_what_is_determined_but_nan_does_not_hold():
    tallied = tally([verdict(CLAIM, value) for value in (100.0, 140.0, math.nan)])
    assert (tallied.mean, tallied.spread) == (120.0, 20.0)
    assert (tallied.held, tallied.seeds) == (2, 3)


def test_what_no_seed_determines_has_no_mean():
    tallied = tally([verdict(CLAIM, math.nan)])
    assert math.isnan(tallied.mean) and math.isnan(tallied.spread) and not tallied.holds


def test_chapters_are_counted_apart_and_together():
    results = (trial(18), computed())
    assert [(count.claims, count.hold, count.fail) for count in counts(results)] == [(1, 0, 1), (1, 1, 0)]
    assert (total(results).figures, total(results).claims, total(results).hold) == (2, 2, 1)


@pytest.mark.parametrize(
    ("tallied", "status"),
    [(trial(20), 0), (trial(18), 1), (trial(20, gap="tick 3 is missing"), 5), (trial(20, tripped="too much", gap="tick 3"), 3)],
)
def test_the_worst_of_it_decides_the_exit_status(tallied, status):
    assert exit_status((tallied, computed())) == status


def test_a_trip_names_its_seed():
    assert trial(1, 1, tripped="too much").tripped == ("seed 0: too much",)


def test_a_failure_comes_with_its_explanation_or_with_none():
    figure = find_figure("fig-5-13")
    wrong = [verdict(claim, math.nan) for claim in figure.subject.claims if claim.statement == "The mean force is 140 N"]
    known, unknown = failures((result(figure, [(0, Found(figure.name, tuple(wrong)))], ()), trial(0)))
    assert "182 N" in known.why
    assert unknown.why == ""
