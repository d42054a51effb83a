import math

import pytest

from hydrohil.claims.claims import band, verdict
from hydrohil.claims.study import Statement
from hydrohil.reproduction.formatting import briefly, duration, measured, number
from hydrohil.reproduction.formatting import verdict as verdict_words
from hydrohil.reproduction.tally import tally
from tests.support.reproduction_scene import CLAIM, computed, trial, verdicts


def test_one_seed_is_a_number_and_several_are_mean_spread_and_range():
    assert measured(tally([verdict(CLAIM, 123.456)])) == "123 N"
    assert measured(tally([verdict(CLAIM, value) for value in (100.0, 140.0)])) == "120 ± 20 N (100..140)"


def test_briefly_is_mean_and_spread():
    assert briefly(tally([verdict(CLAIM, 123.456)])) == "123 N"
    assert briefly(tally([verdict(CLAIM, value) for value in (100.0, 140.0)])) == "120 ± 20 N"


def test_what_is_not_determined_is_said():
    assert measured(tally([verdict(CLAIM, math.nan)])) == "not determined"
    assert measured(tally([verdict(CLAIM, value) for value in (100.0, math.nan)])).endswith("not determined in 1")
    assert number(math.nan) == "-"


def test_the_band_is_stated_with_its_unit():
    assert band(tally(verdicts(1, 1)).claim) == "below 160 N"
    assert band(computed().tallies[0].claim) == "within 1..2 mm"
    once = Statement("Once", "within", "counts", 1.0, 1.0)
    assert band(once) == "exactly 1 counts"


def test_a_verdict_over_seeds_says_in_how_many():
    assert verdict_words(trial(19).tallies[0]) == "holds: 19 of 20"
    assert verdict_words(trial(18).tallies[0]) == "does NOT hold: 18 of 20"
    assert verdict_words(tally(verdicts(1, 1))) == "holds"


@pytest.mark.parametrize(("seconds", "words"), [(12.34, "12.3 s"), (120.0, "2 min"), (7200.0, "2.0 h")])
def test_durations_are_in_units_that_suit_them(seconds, words):
    assert duration(seconds) == words
