"""The report of a trip: rule, numbers, moment, stop, ages, counters, words."""

import json
import math

import pytest

from hydrohil.shared.contract.messages import LinkStats, TripCause
from hydrohil.shared.trips.formatting import lines, markdown
from hydrohil.shared.trips.report import counters_of, newest_trip, stop, trip_report
from hydrohil.shared.trips.tables import tables
from tests.support.recorder_trial import DESCRIPTION, PERIOD_NS
from tests.support.trip_scene import COUNTS, GATE, ORIGIN, SUPERVISOR, TRIP_NUMBER, TRIP_TICK, caught, report, tripping

TRIP_S = TRIP_TICK * PERIOD_NS * 1e-9


def signals(by=SUPERVISOR, **options):
    return tables(caught(tripping(by, **options)).messages)


def test_the_supervisor_s_trip_has_rule_numbers_and_moment():
    document = report()
    assert (document["by"], document["cause"], document["measured"], document["limit"]) == (
        "supervisor",
        "FORCE_TARED",
        341.2,
        334.1,
    )
    assert (document["sample"], document["tick"]) == (TRIP_NUMBER, TRIP_TICK)
    assert document["trial_time_s"] == pytest.approx(TRIP_S)
    assert "force limit" in document["must_hold"] and "hydrohil reset" in document["to_do"]


def test_a_trip_names_the_machine_that_was_described():
    document = report()
    assert (document["machine"], document["machine_hash"]) == ("unimate", DESCRIPTION.machine_hash.hex())


def test_the_sentence_says_what_when_how_soon_and_what_moved():
    text = report()["sentence"]
    assert text.startswith(
        "The contact force reached 341.2 N against its limit of 334.1 N "
        f"at sample {TRIP_NUMBER} (tick {TRIP_TICK}, {TRIP_S:.3f} s); "
        "the gate was at zero current 1 sample later; meanwhile the tip moved "
    )
    assert text.endswith(".") and " mm" in text


def test_a_cut_of_the_gate_decides_where_the_supervisor_only_says_that_there_was_one():
    document = report(GATE)
    assert (document["by"], document["cause"], document["sample"]) == ("gate", "FORCE_ABOVE_LIMIT", TRIP_NUMBER)
    assert document["sentence"].startswith(
        "The gate cut by itself: the raw force reached 431.9 N against the gate's own limit of 420.0 N"
    )


def test_a_cut_without_a_supervisor_that_reports_is_a_trip():
    topics = signals(GATE)
    del topics["supervisor/permit"]
    trip = newest_trip(topics)
    assert trip is not None and (trip.by, trip.sample) == ("gate", TRIP_NUMBER)


def test_an_old_cut_does_not_stand_for_a_new_trip_of_the_supervisor():
    topics = signals(SUPERVISOR)
    topics["plant/gate"] = signals(GATE)["plant/gate"]
    trip = newest_trip(topics)
    assert trip is not None and (trip.by, trip.cause) == ("supervisor", "FORCE_TARED")


def test_without_a_trip_there_is_no_report():
    topics = {topic: {name: column[:50] for name, column in table.items()} for topic, table in signals().items()}
    assert trip_report(topics, ORIGIN) is None
    assert trip_report({}, ORIGIN) is None


def test_zero_is_the_first_sample_that_shows_every_code_at_zero():
    topics = signals()
    assert stop(topics, TRIP_NUMBER, 1.0)["samples_later"] == 1
    assert stop(topics, TRIP_NUMBER + 1, 1.0)["samples_later"] == 0
    row = topics["plant/sample"]["number"].index(TRIP_NUMBER + 1)
    topics["plant/sample"]["dac_counts[2]"][row] = 2049
    assert stop(topics, TRIP_NUMBER, 1.0)["samples_later"] == 2
    assert stop({}, TRIP_NUMBER, 1.0)["zero_sample"] is None


def test_the_tip_s_way_is_the_largest_distance_from_where_it_tripped():
    topics = signals()
    table = topics["plant/ground_truth"]
    first = table["number"].index(TRIP_NUMBER)
    here = [table[f"tip_m[{k}]"][first] for k in range(3)]
    far = max(math.dist(here, [table[f"tip_m[{k}]"][i] for k in range(3)]) for i in range(first, len(table["number"])))
    assert stop(topics, TRIP_NUMBER, 1.0)["tip_moved_m"] == pytest.approx(far)
    assert stop(topics, TRIP_NUMBER, 1.0)["tip_from"] == "the emulator's ground truth"
    del topics["plant/ground_truth"]
    assert stop(topics, TRIP_NUMBER, 1.0)["tip_from"] == "the encoders"
    assert stop(topics, TRIP_NUMBER, 1.0)["tip_moved_m"] > 0.0


def test_a_trip_whose_sample_was_the_last_has_nothing_to_say_of_afterwards():
    topics = signals(ticks=TRIP_TICK + 1)
    document = trip_report(topics, ORIGIN)
    assert document is not None
    assert document["stop"]["tip_moved_m"] is None and document["stop"]["zero_sample"] is None
    assert document["sentence"].endswith("no later sample has shown the gate at zero current.")


def test_the_signals_are_those_that_were_sent_at_the_full_rate():
    document = report()
    sent = [m for m in tripping(SUPERVISOR) if m.topic == "controller/state"]
    table = document["signals"]["controller/state"]
    assert table["force_n"] == [m.body.force_n for m in sent]
    assert table["q[1]"] == [m.body.q[1] for m in sent]
    assert table["arrival_ns"] == [m.arrival_ns for m in sent]
    assert json.loads(json.dumps(document, allow_nan=False)) == document


def test_a_number_that_is_nan_is_null_and_still_in_the_sentence():
    topics = signals()
    topics["supervisor/permit"]["measured"] = [math.nan] * len(topics["supervisor/permit"]["measured"])
    document = trip_report(topics, ORIGIN)
    assert document is not None and document["measured"] is None
    assert "nan N" in document["sentence"]
    assert set(document["signals"]["supervisor/permit"]["measured"]) == {None}


def test_a_trip_outside_a_trial_has_no_tick():
    topics = signals(cause=TripCause.ESTOP)
    topics["plant/sample"]["tick"] = [-(2**31)] * len(topics["plant/sample"]["tick"])
    document = trip_report(topics, ORIGIN)
    assert document is not None and (document["tick"], document["trial_time_s"]) == (None, None)
    assert document["sentence"].startswith(f"The operator pressed the emergency stop at sample {TRIP_NUMBER};")


def test_counters_are_those_of_each_receiver_without_zeros():
    counted = counters_of({"plant": LinkStats(5, (COUNTS,))})
    assert counted == {"plant": {"controller/command": {"accepted": 900, "lost": 2, "link_faults": 1, "crc": 1}}}
    text = "\n".join(lines(report() | {"counters": counted}))
    assert "plant of controller/command: 2 lost, 1 link faults, 1 crc" in text
    assert "nothing lost" in "\n".join(lines(report() | {"counters": {"plant": {"x": {"accepted": 3}}}}))


def test_words_and_markdown_say_the_same():
    document = report()
    for hop in document["ages"]:
        assert any(hop["hop"] in line and hop["clock"] in line for line in lines(document))
        assert hop["hop"] in markdown(document)
    assert lines(document)[0] == document["sentence"]
    assert document["sentence"] in markdown(document)
