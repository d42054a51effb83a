"""The mode machine, exhaustively: 5 modes x 8 events x every cause or none x 2^6 flags. Properties, no second machine."""

from itertools import product

import pytest

from hydrohil.services.supervisor.modes import Event, Facts, next_mode
from hydrohil.shared.contract.messages import Mode, TripCause

FLAGS = Facts._fields[1:]
CAUSES = [int(cause) for cause in TripCause]
FACTS = [Facts(broken, *flags) for broken, *flags in product(CAUSES, *[(False, True)] * len(FLAGS))]
LATCHED = (Mode.TRIPPED, Mode.RECOVER)
PERMITTED = (Mode.ARMED, Mode.RUNNING)


@pytest.fixture(scope="module")
def walked():
    """(mode, event, facts, mode after) of every step there is."""
    return [(m, e, f, next_mode(m, e, f)) for m, e, f in product(map(int, Mode), map(int, Event), FACTS)]


def test_every_step_leads_to_a_mode(walked):
    assert len(walked) == len(Mode) * len(Event) * len(TripCause) * 2 ** len(FLAGS)
    assert {after for *_, after in walked} == set(map(int, Mode))
    assert all(type(after) is int for *_, after in walked)


def test_an_emergency_stop_wins_from_everywhere(walked):
    stops = [after for _, event, facts, after in walked if facts.estop or event == Event.ESTOP]
    assert len(stops) == len(walked) * 9 // 16  # half of the facts, and an eighth of the rest
    assert set(stops) == {Mode.TRIPPED}


def test_nothing_leaves_tripped_by_itself_whatever_the_facts(walked):
    alone = [after for mode, event, _, after in walked if (mode, event) == (Mode.TRIPPED, Event.NOTHING)]
    assert len(alone) == len(FACTS)
    assert set(alone) == {Mode.TRIPPED}


def test_a_latched_state_is_left_only_by_a_reset_with_the_cause_gone(walked):
    left = [(mode, event, facts, after) for mode, event, facts, after in walked if mode in LATCHED and after not in LATCHED]
    assert left
    for mode, event, facts, after in left:
        assert (mode, event, facts.broken, facts.estop, after) == (Mode.TRIPPED, Event.RESET, 0, False, Mode.DISARMED)


def test_recover_comes_only_from_tripped_and_goes_only_back(walked):
    assert {mode for mode, _, _, after in walked if after == Mode.RECOVER} == {Mode.TRIPPED, Mode.RECOVER}
    assert {after for mode, _, _, after in walked if mode == Mode.RECOVER} == {Mode.TRIPPED, Mode.RECOVER}
    entered = [(event, facts) for mode, event, facts, after in walked if mode == Mode.TRIPPED and after == Mode.RECOVER]
    assert all(event == Event.HOLD_RECOVER and facts.can_recover and not facts.estop for event, facts in entered)


def test_recover_is_held_to_run(walked):
    stays = [(e, f) for mode, e, f, after in walked if mode == after == Mode.RECOVER]
    assert all(facts.held and facts.can_recover and not facts.estop for _, facts in stays)
    assert {event for event, _ in stays} == {Event.NOTHING, Event.HOLD_RECOVER}


def test_no_event_leads_from_disarmed_to_running(walked):
    assert {after for mode, *_, after in walked if mode == Mode.DISARMED} == {Mode.DISARMED, Mode.ARMED, Mode.TRIPPED}


def test_permission_is_gained_only_by_an_operator_s_act_with_nothing_broken(walked):
    acts = {Mode.ARMED: (Mode.DISARMED, Event.ARM), Mode.RUNNING: (Mode.ARMED, Event.START)}
    for mode, event, facts, after in walked:
        if after in PERMITTED and after != mode:
            assert (mode, event) == acts[Mode(after)]
            assert facts.broken == 0 and facts.may_arm and not facts.estop


@pytest.mark.parametrize("mode", PERMITTED)
def test_no_cause_leaves_permission_standing(walked, mode):
    for before, _, facts, after in walked:
        if before == mode and facts.broken:
            assert after not in PERMITTED
            assert mode == Mode.ARMED or after == Mode.TRIPPED


def test_which_rule_is_broken_makes_no_difference_only_that_one_is(walked):
    by_flags: dict[tuple, set[int]] = {}
    for mode, event, facts, after in walked:
        by_flags.setdefault((mode, event, facts.broken != 0, *facts[1:]), set()).add(after)
    assert {len(modes) for modes in by_flags.values()} == {1}


def test_a_reset_moves_nothing(walked):
    assert not {after for _, event, _, after in walked if event == Event.RESET} & {Mode.RECOVER} - {Mode.TRIPPED}
    for mode, event, _, after in walked:
        if event == Event.RESET:
            assert after in (mode, Mode.DISARMED, Mode.TRIPPED)


def test_losing_a_fact_never_permits_more(walked):
    """Monotone: taking a permitting flag away, or setting a forbidding one, leads to no mode that permits more."""
    rank = {Mode.TRIPPED: 0, Mode.DISARMED: 0, Mode.RECOVER: 1, Mode.ARMED: 1, Mode.RUNNING: 2}
    forbidding = {"estop": True, "may_arm": False, "can_recover": False, "held": False, "finished": True, "armed_too_long": True}
    assert set(forbidding) == set(FLAGS)
    for mode, event, facts, after in walked:
        for flag, value in forbidding.items():
            assert rank[Mode(next_mode(mode, event, facts._replace(**{flag: value})))] <= rank[Mode(after)]
