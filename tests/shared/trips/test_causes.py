"""What is said of each cause."""

import pytest

from hydrohil.shared.contract.messages import GateCause, TripCause
from hydrohil.shared.trips.causes import CUTS, TRIPS, cut_happened, cut_words, trip_happened, trip_words


def test_what_happened_has_its_numbers_and_units():
    assert trip_happened(TripCause.FORCE_TARED, 341.23, 334.09) == (
        "the contact force reached 341.2 N against its limit of 334.1 N"
    )
    assert cut_happened(GateCause.PERMIT_STALE, 0.0215, 0.02) == "the permit was 0.0215 s old against a lease of 0.02 s"


def test_a_trip_names_its_sample_and_an_emergency_stop_has_no_number():
    assert trip_words(TripCause.FORCE_RAW, 431.25, 420.0, 17) == (
        "the raw force reached 431.2 N against its limit of 420.0 N (sample 17)"
    )
    assert trip_words(TripCause.ESTOP, 0.0, 0.0, 17) == "the operator pressed the emergency stop (sample 17)"


def test_a_cut_names_the_gate_and_its_sample():
    assert cut_words(GateCause.NO_PERMIT, 0.0, 0.0, 17) == "the gate cut by itself: there was no permit (sample 17)"


@pytest.mark.parametrize(("table", "happened"), [(TRIPS, trip_happened), (CUTS, cut_happened)])
def test_every_row_has_words_for_any_number(table, happened):
    for cause, row in table.items():
        assert happened(cause, float("nan"), float("inf"))
        assert all(len(words) > 10 and not words.endswith(".") for words in row[:3])


def test_every_cause_of_a_trip_or_a_cut_has_words():
    assert set(TRIPS) == set(TripCause) - {TripCause.NONE}
    assert set(CUTS) == set(GateCause) - {GateCause.NONE}


def test_a_trip_with_a_limit_has_its_unit_and_says_it():
    for row in TRIPS.values():
        assert bool(row.unit) == ("{limit" in row.happened)
        assert row.unit in row.happened


def test_a_cause_of_another_version_is_reported_by_its_number():
    assert trip_happened(99, 2.0, 1.92) == "cause 99: 2 against 1.92"
    assert cut_happened(99, 2.0, 1.92) == "cause 99: 2 against 1.92"
