"""What `hydrohil explain` shows is what supervisor and gate do."""

import pytest

from hydrohil.explanation import walk
from hydrohil.explanation.conditions import CONDITIONS, ZERO
from hydrohil.explanation.walk import Scene, after, deciding, describe, reached
from hydrohil.services.plant.gate import gate_step
from hydrohil.services.supervisor.modes import Event, next_mode
from hydrohil.services.supervisor.rules import RULES, fold
from hydrohil.shared.contract.messages import GateCause, GateState, Mode, TripCause

CAUSES = [rule.cause for rule in RULES]
RUNNING, RECOVERING = reached(Mode.RUNNING), reached(Mode.RECOVER)


def test_what_decides_is_the_code_of_a_cell():
    used = vars(walk)
    assert (used["next_mode"], used["gate_step"], used["fold"], used["RULES"]) == (next_mode, gate_step, fold, RULES)


@pytest.mark.parametrize("mode", Mode)
def test_every_mode_is_reached_by_events(mode: Mode):
    assert reached(mode).mode == mode


def test_only_running_and_recover_let_current_through():
    assert {mode for mode in Mode if reached(mode).gate.codes != ZERO} == {Mode.RUNNING, Mode.RECOVER}


@pytest.mark.parametrize("cause", CAUSES)
def test_every_broken_rule_trips_and_is_latched(cause: TripCause):
    scene = after(RUNNING._replace(broken=frozenset([cause])), Event.NOTHING)
    assert (scene.mode, scene.cause, scene.gate.codes) == (Mode.TRIPPED, cause, ZERO)
    mended = after(scene._replace(broken=frozenset()), Event.NOTHING)
    assert (mended.mode, mended.cause) == (Mode.TRIPPED, cause)
    assert after(mended, Event.RESET) == after(mended, Event.RESET)._replace(
        mode=Mode.DISARMED, cause=TripCause.NONE, arming_id=0
    )


@pytest.mark.parametrize("cause", CONDITIONS)
def test_every_broken_condition_is_the_gate_s_own_cause(cause: GateCause):
    scene = after(RECOVERING if cause == GateCause.NOT_UNLOADING else RUNNING, Event.HOLD_RECOVER)
    scene = after(scene._replace(conditions=frozenset([cause])), Event.HOLD_RECOVER)
    assert (GateCause(scene.gate.cause), scene.gate.codes) == (cause, ZERO)


def test_a_cut_of_the_gate_trips_the_supervisor_a_sample_later():
    cut = after(RUNNING._replace(conditions=frozenset([GateCause.COMMAND_STALE])), Event.NOTHING)
    assert (cut.mode, GateState(cut.gate.state)) == (Mode.RUNNING, GateState.REVOKED)
    assert describe(cut)["decides"] == "GATE_CUT"
    tripped = after(cut, Event.NOTHING)
    assert (tripped.mode, tripped.cause) == (Mode.TRIPPED, TripCause.GATE_CUT)


def test_an_emergency_stop_is_recovered_from_only_after_a_reset():
    pressed = after(RUNNING, Event.ESTOP)._replace(broken=frozenset([TripCause.FORCE_RAW]))
    assert after(pressed, Event.HOLD_RECOVER).mode == Mode.TRIPPED
    refused = after(pressed, Event.RESET)
    assert (refused.mode, after(refused, Event.HOLD_RECOVER).mode) == (Mode.TRIPPED, Mode.RECOVER)


def test_an_emergency_stop_at_the_gate_stands_until_it_is_released():
    pressed = after(after(RUNNING._replace(conditions=frozenset([GateCause.ESTOP])), Event.NOTHING), Event.NOTHING)
    assert (pressed.mode, pressed.cause) == (Mode.TRIPPED, TripCause.ESTOP)
    assert after(pressed, Event.RESET).mode == Mode.TRIPPED
    released = after(pressed._replace(conditions=frozenset()), Event.NOTHING)
    assert after(released, Event.RESET).mode == Mode.DISARMED


def test_of_several_broken_rules_the_most_severe_decides():
    assert deciding(frozenset(CAUSES)) == CAUSES[0]
    assert deciding(frozenset()) == TripCause.NONE


def test_each_event_s_outcome_is_what_happens_then():
    state = describe(Scene())
    assert state["events"]["arm"].startswith("ARMED")
    assert set(state["events"]) == {event.name.lower() for event in Event}
