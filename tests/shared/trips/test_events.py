from hydrohil.shared.contract.messages import GateCause, GateEvent, GateState, InboxCounts, ParameterEvent, Permit
from hydrohil.shared.trips.events import gap_event, gate_event, is_reported, link_stats_event, parameter_event, permit_events
from hydrohil.shared.trips.gaps import Counted, Sequence
from tests.support.recorder_trial import received, trial


def permits() -> list[Permit]:
    return [m.body for m in trial(20, trip_tick=10) if isinstance(m.body, Permit)]


def log_lines() -> list[str]:
    every = permits()
    return [event.text for before, now in zip([None, *every], every, strict=False) for event in permit_events(before, now)]


def test_the_log_of_a_trial_has_its_modes_and_the_trip_with_its_numbers():
    announced = "trial announced: first sample 1030, 444 ticks of force bias, then 3000"
    tripped = "tripped: the contact force reached 341.2 N against its limit of 334.0 N (sample 1484)"
    assert log_lines() == ["disarmed", "disarmed -> armed", announced, "armed -> running", tripped]


def test_a_permit_that_only_repeats_is_not_logged():
    permit = permits()[0]
    assert permit_events(permit, permit) == []


def test_a_trial_announced_within_a_mode_is_logged():
    armed = permits()[100]
    later = armed._replace(first_sample=armed.first_sample + 500)
    assert [e.text for e in permit_events(armed, later)] == [
        f"trial announced: first sample {later.first_sample}, 444 ticks of force bias, then 3000"
    ]


def test_an_unknown_mode_is_logged_as_its_number():
    permit = permits()[0]
    assert permit_events(permit, permit._replace(mode=42))[0].text == "disarmed -> 42"


def test_a_revoked_gate_is_an_error_and_a_shut_one_a_warning():
    event = GateEvent(
        number=3,
        tick=2,
        state=GateState.REVOKED,
        cause=GateCause.FORCE_ABOVE_LIMIT,
        permit_age_ns=0,
        command_age_ns=0,
        measured=431.9,
        limit=420.0,
    )
    assert gate_event(event).level == "ERROR"
    assert gate_event(event).text == (
        "gate revoked: the raw force reached 431.9 N against the gate's own limit of 420.0 N (sample 3)"
    )
    assert gate_event(event._replace(state=GateState.SHUT)).level == "WARN"


def test_a_gate_that_opens_has_no_cause():
    event = GateEvent(
        number=4, tick=3, state=GateState.OPEN, cause=GateCause.NONE, permit_age_ns=0, command_age_ns=0, measured=0.0, limit=0.0
    )
    assert gate_event(event).text == "gate open (sample 4)"


def test_a_gap_names_the_numbers_that_are_missing():
    header = received("plant/sample", permits()[0], 10).header
    event = gap_event("plant/sample", header, Counted(Sequence(77, 10), 3, False))
    assert event is not None and event.text == "3 missing on plant/sample from plant: 7 to 9"
    assert gap_event("plant/sample", header, Counted(Sequence(77, 10), 0, False)) is None


def test_refusals_are_logged_at_each_doubling():
    assert [n for n in range(1, 20) if is_reported(n)] == [1, 2, 4, 8, 16]


def test_a_count_that_grows_is_logged_and_the_first_report_is_the_base():
    base = InboxCounts("plant/sample", 100, 1, *(0,) * 12)
    assert link_stats_event("supervisor", None, base) is None
    assert link_stats_event("supervisor", base, base._replace(accepted=200)) is None
    event = link_stats_event("supervisor", base, base._replace(lost=4, crc=2, link_faults=1))
    assert event == ("supervisor", "WARN", "supervisor of plant/sample: 3 lost, 1 link faults, 2 crc")
    assert link_stats_event("supervisor", base._replace(lost=9), base) is None  # it started anew


def test_a_parameter_changed_by_hand_is_a_warning_and_a_scheduled_one_is_not():
    event = ParameterEvent(number=40, tick=12, by_hand=1, path="controller.law", old='"final"', new='"pi"', ramp_samples=1)
    assert parameter_event(event) == (
        "controller",
        "WARN",
        'changed by hand at sample 40: controller.law "final" -> "pi"',
    )
    scheduled = parameter_event(event._replace(by_hand=0, ramp_samples=111))
    assert scheduled.level == "INFO"
    assert scheduled.text == 'changed as scheduled at sample 40: controller.law "final" -> "pi" over 111 samples'
