"""The last seconds of everything, and when a trip is complete."""

import pytest

from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import Mode, ParameterEvent
from hydrohil.shared.trips.formatting import lines, markdown
from hydrohil.shared.trips.ring import AFTER_NS, KEPT_NS, PATIENCE_NS, TripRing
from hydrohil.shared.trips.watcher import document_of
from tests.support.recorder_trial import PERIOD_NS, trial
from tests.support.trip_scene import GATE, SUPERVISOR, TRIP_NUMBER, TRIP_TICK, link_stats, tripping

AFTER = -(-AFTER_NS // PERIOD_NS)  # samples


def fed(messages, ring=None):
    ring = ring or TripRing()
    for message in messages:
        ring.take(message)
    return ring


def numbers(caught, topic="plant/sample"):
    return [m.body.number for m in caught.messages[topic]]


@pytest.mark.parametrize("by", [SUPERVISOR, GATE])
def test_one_trip_is_one_report_that_waits_for_what_comes_after(by):
    ring, found = TripRing(), []
    for message in tripping(by):
        ring.take(message)
        newly = ring.caught(0)
        found += newly
        if newly:
            assert numbers(newly[0])[-1] == TRIP_NUMBER + AFTER
    assert len(found) == 1
    assert ring.caught(10**18, at_once=True) == []


def test_without_a_trip_nothing_is_caught():
    ring = fed(tripping(SUPERVISOR, ticks=TRIP_TICK))
    assert ring.caught(10**18, at_once=True) == []


def test_a_plant_that_is_gone_is_not_waited_for_longer_than_the_patience():
    ring = fed(tripping(SUPERVISOR, ticks=TRIP_TICK + 1))
    arrival_ns = next(
        m.arrival_ns for m in tripping(SUPERVISOR) if m.topic == "supervisor/permit" and m.body.mode == Mode.TRIPPED
    )
    assert ring.caught(arrival_ns + PATIENCE_NS - 1) == []
    (caught,) = ring.caught(arrival_ns + PATIENCE_NS)
    assert numbers(caught)[-1] == TRIP_NUMBER


def shifted(messages, by):
    """The same later: another ten seconds and more have passed in between."""
    for m in messages:
        changes = {name: value + by for name, value in (("number", getattr(m.body, "number", None)),) if value is not None}
        if "time_ns" in m.body._fields:
            changes["time_ns"] = m.body.time_ns + by * PERIOD_NS
        if m.topic == "supervisor/permit" and m.body.trip_number >= 0:
            changes["trip_number"] = m.body.trip_number + by
        head = m.header
        head = head._replace(echo_number=head.echo_number + by, echo_time_ns=head.echo_time_ns + by * PERIOD_NS)
        yield m._replace(body=m.body._replace(**changes), header=head)


def test_the_ring_holds_the_last_ten_seconds_before_a_trip_and_no_more():
    ring = TripRing()
    for part in range(8):
        fed(shifted(tripping(SUPERVISOR, ticks=TRIP_TICK), 800 * part), ring)
    fed(shifted(tripping(SUPERVISOR), 6400), ring)
    (caught,) = ring.caught(0)
    at = TRIP_NUMBER + 6400
    before = [n for n in numbers(caught) if n < at]
    times = [m.header.echo_time_ns for m in caught.messages["plant/sample"]]
    tripped_ns = times[numbers(caught).index(at)]
    assert before and KEPT_NS <= tripped_ns - times[0] <= KEPT_NS + 1.1e9
    assert {
        topic for topic, kept in caught.messages.items() if tripped_ns - kept[0].header.echo_time_ns > KEPT_NS + 1.1e9
    } == set()


def test_a_second_trip_is_a_second_report():
    ring = fed(tripping(SUPERVISOR))
    assert len(ring.caught(0)) == 1
    again = list(shifted(tripping(SUPERVISOR), 2000))
    fed(again, ring)
    (caught,) = ring.caught(0)
    assert TRIP_NUMBER + 2000 in numbers(caught)


def test_a_reset_hands_a_trip_over_at_once():
    ring = fed(tripping(SUPERVISOR, ticks=TRIP_TICK + 3))
    assert ring.caught(0) == []
    last = next(m for m in tripping(SUPERVISOR) if m.topic == "supervisor/permit")
    ring.take(last._replace(body=last.body._replace(mode=int(Mode.DISARMED))))
    assert len(ring.caught(0)) == 1


def test_the_release_of_a_recovery_is_no_other_trip():
    ring = fed(tripping(SUPERVISOR))
    ring.caught(0)
    last = [m for m in tripping(SUPERVISOR) if m.topic == "supervisor/permit"][-1]
    for mode in (Mode.RECOVER, Mode.TRIPPED):
        ring.take(last._replace(body=last.body._replace(mode=int(mode))))
    assert ring.caught(0, at_once=True) == []


def test_a_supervisor_that_is_first_heard_tripped_has_tripped_before():
    late = [m for m in tripping(SUPERVISOR) if m.header.echo_number > TRIP_NUMBER]
    assert fed(late).caught(0, at_once=True) == []


def test_another_plant_hands_over_and_begins_anew():
    ring = fed(tripping(GATE, ticks=TRIP_TICK + 3))
    other = next(m for m in tripping(GATE) if m.topic == "plant/sample")
    ring.take(other._replace(header=other.header._replace(epoch=4)))
    (caught,) = ring.caught(0)
    assert numbers(caught)[-1] == TRIP_NUMBER + 2
    assert ring.caught(0, at_once=True) == []


def test_the_newest_counters_of_each_receiver_go_with_it():
    ring = fed([link_stats(3), link_stats(9), *tripping(SUPERVISOR)])
    (caught,) = ring.caught(0)
    assert {sender: stats.number for sender, stats in caught.link_stats_by_receiver.items()} == {"plant": 9}
    assert caught.description is not None


def changed(by_hand, number):
    event = ParameterEvent(
        number=number, tick=number - 1030, by_hand=by_hand, path="controller.law", old='"final"', new='"pi"', ramp_samples=1
    )
    return Received(0, "controller/parameter_change", next(iter(tripping(SUPERVISOR))).header, event)


def test_what_was_changed_by_hand_in_the_trial_belongs_to_its_trip_however_long_before():
    ring = TripRing()
    early = changed(1, 1040)
    ring.take(early)
    for part in range(8):  # a minute
        fed(shifted(tripping(SUPERVISOR, ticks=TRIP_TICK), 800 * part), ring)
    ring.take(changed(0, 1050))
    fed(shifted(tripping(SUPERVISOR), 6400), ring)
    (caught,) = ring.caught(0)
    assert caught.changes == (early.body,)
    document = document_of(caught, "", "cell", "the recorder's", {})
    assert document["changed"] == ['changed by hand at sample 1040: controller.law "final" -> "pi"']
    assert document["changed"][0] in lines(document) and document["changed"][0] in markdown(document)


def disarmed(message):
    return message.topic == "supervisor/permit" and message.body.mode == Mode.DISARMED


def test_what_was_changed_in_a_trial_before_is_forgotten():
    ring = fed([changed(1, 1040), *filter(disarmed, trial(20))])
    fed(tripping(SUPERVISOR), ring)
    (caught,) = ring.caught(0)
    assert caught.changes == ()
