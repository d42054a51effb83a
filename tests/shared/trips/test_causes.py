"""What is said of each cause."""

import pytest

from hydrohil.shared.contract.messages import GateCause, TripCause
from hydrohil.shared.trips.causes import CUTS, TRIPS, cut_happened, trip_happened


def test_what_happened_has_its_numbers_and_units():
    assert trip_happened(TripCause.FORCE_TARED, 341.23, 334.09) == (
        "the contact force reached 341.2 N against its limit of 334.1 N"
    )
    assert cut_happened(GateCause.PERMIT_STALE, 0.0215, 0.02) == "the permit was 0.0215 s old against a lease of 0.02 s"


@pytest.mark.parametrize(("table", "told"), [(TRIPS, trip_happened), (CUTS, cut_happened)])
def test_every_row_can_be_told_of_any_number(table, told):
    for cause, row in table.items():
        assert told(cause, float("nan"), float("inf"))
        assert all(len(words) > 10 and not words.endswith(".") for words in row)


def test_every_cause_of_a_trip_or_a_cut_is_told_in_words():
    assert set(TRIPS) == set(TripCause) - {TripCause.NONE}
    assert set(CUTS) == set(GateCause) - {GateCause.NONE}


def test_a_cause_without_a_row_is_told_by_its_name(monkeypatch):
    monkeypatch.delitem(TRIPS, TripCause.JOINT_LIMIT)
    assert trip_happened(TripCause.JOINT_LIMIT, 2.0, 1.92) == "joint limit: 2 against 1.92"


def test_every_cause_has_words():
    assert set(TRIPS) == set(TripCause) - {TripCause.NONE}
    assert set(CUTS) == set(GateCause) - {GateCause.NONE}
