"""Ages at a trip: each of one clock, and it says whose."""

import pytest

from hydrohil.shared.trips.ages import ages
from hydrohil.shared.trips.tables import row_of, tables
from tests.support.trip_scene import GATE, SUPERVISOR, TRIP_NUMBER, caught, tripping


def hops(by):
    signals = tables(caught(tripping(by)).messages)
    return signals, {hop["hop"]: hop for hop in ages(signals, by, TRIP_NUMBER, "mine")}


@pytest.mark.parametrize("by", [SUPERVISOR, GATE])
def test_the_ages_at_the_gate_are_on_the_plant_s_clock(by):
    signals, found = hops(by)
    row = row_of(signals["plant/sample"], TRIP_NUMBER)
    accepted = found[f"sample {TRIP_NUMBER - 1} -> its command accepted by the gate"]
    assert accepted["age_s"] == signals["plant/sample"]["command_age_ns"][row] * 1e-9
    assert accepted["clock"] == "the plant's"
    decided = [hop for name, hop in found.items() if name.endswith(f"the gate decides on sample {TRIP_NUMBER}")]
    assert [hop["age_s"] for hop in decided] == ([0.0036, 0.0036] if by == GATE else [])


def test_the_ages_of_arrivals_are_on_the_receiver_s_clock():
    signals, found = hops(SUPERVISOR)
    heard = {name: hop for name, hop in found.items() if hop["clock"] == "mine"}
    samples, permits = signals["plant/sample"], signals["supervisor/permit"]
    at, judged = row_of(samples, TRIP_NUMBER), row_of(permits, TRIP_NUMBER, "echo_number")
    age_ns = permits["arrival_ns"][judged] - samples["arrival_ns"][at]
    assert heard[f"sample {TRIP_NUMBER} heard -> its permit heard"]["age_s"] == age_ns * 1e-9
    assert {name.split(" ")[0] for name in heard} == {"sample", "last"}


def test_every_clock_is_named_and_none_is_mixed():
    assert {hop["clock"] for hop in hops(GATE)[1].values()} == {"the plant's", "the controller's", "mine"}


def test_the_last_message_before_the_trip_is_named_by_its_sample():
    found = hops(SUPERVISOR)[1]
    assert f"last sample heard (sample {TRIP_NUMBER}) -> the trip heard" in found
    assert f"last permit heard (sample {TRIP_NUMBER - 1}) -> the trip heard" in found


def test_signals_without_stamps_have_the_ages_that_they_have():
    signals = {"plant/sample": {"number": [1, 2], "command_number": [0, 1], "command_age_ns": [5, 6]}}
    (hop,) = ages(signals, SUPERVISOR, 2, "mine")
    assert hop["age_s"] == 6e-9
    assert ages({}, GATE, 2, "mine") == []
