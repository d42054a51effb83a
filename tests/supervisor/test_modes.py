"""Every mode crossed with every event and every combination of facts: 5 x 8 x 2^7 steps."""

from itertools import product

import pytest

from hydrohil.services.supervisor.modes import Event, Facts, next_mode
from hydrohil.shared.contract.messages import Mode, TripCause

ALL_FACTS = [Facts(int(TripCause.GATE_CUT) if broken else 0, *rest) for broken, *rest in product([False, True], repeat=7)]
QUIET = Facts(broken=0, estop=False, may_arm=False, can_recover=False, held=False, finished=False, armed_too_long=False)
STEPS = [(mode, event, facts) for mode, event, facts in product(Mode, Event, ALL_FACTS)]


def after(mode, event, facts):
    return Mode(next_mode(int(mode), int(event), facts))


def expected(mode, event, facts):
    """The specification as a table: first row that applies."""
    stop, broken = event == Event.STOP, facts.broken != 0
    hold = event in (Event.NOTHING, Event.HOLD_RECOVER) and facts.held and facts.can_recover
    rows = {
        Mode.DISARMED: [(event == Event.ARM and not broken and facts.may_arm, Mode.ARMED)],
        Mode.ARMED: [
            (broken or stop or facts.armed_too_long or not facts.may_arm, Mode.DISARMED),
            (event == Event.START, Mode.RUNNING),
        ],
        Mode.RUNNING: [(broken, Mode.TRIPPED), (stop or facts.finished, Mode.DISARMED)],
        Mode.TRIPPED: [
            (event == Event.RESET and not broken, Mode.DISARMED),
            (event == Event.HOLD_RECOVER and facts.can_recover, Mode.RECOVER),
        ],
        Mode.RECOVER: [(not hold, Mode.TRIPPED)],
    }[mode]
    if facts.estop or event == Event.ESTOP:
        return Mode.TRIPPED
    return next((to for applies, to in rows if applies), mode)


def test_every_step_is_the_one_specified():
    wrong = [(mode, event, facts) for mode, event, facts in STEPS if after(mode, event, facts) != expected(mode, event, facts)]
    assert wrong == []


def test_an_emergency_stop_trips_from_every_mode():
    stops = [step for step in STEPS if step[2].estop or step[1] == Event.ESTOP]
    assert stops
    assert {after(*step) for step in stops} == {Mode.TRIPPED}


def test_tripped_is_left_by_a_reset_without_a_broken_rule_or_to_recover_and_no_other_way():
    left = [(event, facts, after(Mode.TRIPPED, event, facts)) for mode, event, facts in STEPS if mode == Mode.TRIPPED]
    left = [(event, facts, to) for event, facts, to in left if to != Mode.TRIPPED]
    assert {to for _, _, to in left} == {Mode.DISARMED, Mode.RECOVER}
    for event, facts, to in left:
        if to == Mode.DISARMED:
            assert event == Event.RESET
            assert facts.broken == 0
        else:
            assert event == Event.HOLD_RECOVER
            assert facts.can_recover


def test_running_is_entered_only_from_armed_by_start_with_nothing_broken():
    entered = [step for step in STEPS if after(*step) == Mode.RUNNING and step[0] != Mode.RUNNING]
    assert entered
    for mode, event, facts in entered:
        assert (mode, event, facts.broken, facts.may_arm, facts.armed_too_long) == (Mode.ARMED, Event.START, 0, True, False)


def test_nothing_gains_permission_without_an_operators_act():
    for mode, facts in product(Mode, ALL_FACTS):
        to = after(mode, Event.NOTHING, facts)
        assert to in (mode, Mode.DISARMED, Mode.TRIPPED)
        assert not (mode == Mode.TRIPPED and to != Mode.TRIPPED)


def test_recover_leads_nowhere_but_back_to_tripped():
    assert {after(*step) for step in STEPS if step[0] == Mode.RECOVER} == {Mode.RECOVER, Mode.TRIPPED}


@pytest.mark.parametrize("event", [Event.STOP, Event.RELEASE, Event.ARM, Event.START, Event.RESET])
def test_any_request_but_holding_ends_a_recovery(event):
    assert after(Mode.RECOVER, event, QUIET._replace(held=True, can_recover=True)) == Mode.TRIPPED


def test_a_broken_rule_never_leaves_the_machine_permitted():
    for mode, event, facts in STEPS:
        if facts.broken and mode != Mode.RECOVER:
            assert after(mode, event, facts) not in (Mode.ARMED, Mode.RUNNING)


def test_events_are_numbered_from_nothing_on():
    assert [int(event) for event in Event] == list(range(8))
