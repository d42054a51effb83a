import math

import pytest

from hydrohil.services.plant.gate import NO_COMMAND_OBSERVATION, NO_PERMIT_OBSERVATION, GateInput, GateMemory
from hydrohil.shared.contract.messages import GateCause, GateState, Mode
from tests.support.gate_scene import (
    ARMING_ID,
    COMMAND,
    CONTROLLER,
    FINE,
    LIMITS,
    NO_SIGNS,
    OTHER,
    PERMIT,
    SUPERVISOR,
    TTL,
    UNLOAD_UP,
    ZERO,
    codes,
    command,
    opened,
    permit,
    recovering,
    step,
)

NOTHING_OBSERVED = GateInput(
    permit=NO_PERMIT_OBSERVATION,
    command=NO_COMMAND_OBSERVATION,
    force_counts=0,
    force_n=0.0,
    tick=0,
    estop=False,
    overrun=False,
    link_faults=0,
    epoch_conflicts=0,
)
AT_ONCE = LIMITS._replace(tight_samples=0)  # no tight slew, so that other limits can be reached in one step

HOLDS = {
    "the permit is as old as its lease": permit(age_ns=TTL),
    "the permit was judged this instant": permit(age_ns=0),
    "the command is as old as its lease": command(age_ns=TTL),
    "the command answers this instant": command(age_ns=0),
    "the trial's first tick": FINE._replace(tick=0),
    "the lowest code": codes(820, 2048, 2048),
    "the highest code": codes(2048, 2048, 3276),
    "the force at its limit": FINE._replace(force_n=420.0),
    "the force at its limit, negative": FINE._replace(force_n=-420.0),
    "the lowest count": FINE._replace(force_counts=0),
    "the highest count": FINE._replace(force_counts=517),
    "one fault of a link within a second": FINE._replace(link_faults=1),
    "a sender that started anew within this second": FINE._replace(epoch_conflicts=1),
}

BROKEN = {
    "a second fault of a link within a second": (FINE._replace(link_faults=2), GateCause.LINK_FAULTS),
    "faults of a link without a permit": (NOTHING_OBSERVED._replace(link_faults=2), GateCause.LINK_FAULTS),
    "two publishers": (FINE._replace(epoch_conflicts=2), GateCause.TWO_PUBLISHERS),
    "two publishers without a permit": (NOTHING_OBSERVED._replace(epoch_conflicts=8), GateCause.TWO_PUBLISHERS),
    "faults of a link and two publishers": (FINE._replace(link_faults=2, epoch_conflicts=2), GateCause.LINK_FAULTS),
    "no permit": (FINE._replace(permit=NO_PERMIT_OBSERVATION), GateCause.NO_PERMIT),
    "a permit that is not there": (permit(present=False), GateCause.NO_PERMIT),
    "a permit without an arming": (permit(arming_id=0), GateCause.NO_PERMIT),
    "a permit just past its lease": (permit(age_ns=TTL + 1), GateCause.PERMIT_STALE),
    "a permit that judges no sample of this plant": (permit(age_ns=-1), GateCause.IMPOSSIBLE_ECHO),
    "a permit that does not run: disarmed": (permit(mode=int(Mode.DISARMED)), GateCause.NOT_RUNNING),
    "a permit that does not run: armed": (permit(mode=int(Mode.ARMED)), GateCause.NOT_RUNNING),
    "a permit that does not run: tripped": (permit(mode=int(Mode.TRIPPED)), GateCause.NOT_RUNNING),
    "a permit of no known mode": (permit(mode=99), GateCause.NOT_RUNNING),
    "the sample before tick 0": (FINE._replace(tick=-1), GateCause.NOT_RUNNING),
    "no trial": (FINE._replace(tick=-(2**31)), GateCause.NOT_RUNNING),
    "no command": (FINE._replace(command=NO_COMMAND_OBSERVATION), GateCause.NO_COMMAND),
    "a command that is not there": (command(present=False), GateCause.NO_COMMAND),
    "a command just past its lease": (command(age_ns=TTL + 1), GateCause.COMMAND_STALE),
    "a command that answers no sample of this plant": (command(age_ns=-1), GateCause.IMPOSSIBLE_ECHO),
    "a command of another arming": (command(arming_id=OTHER), GateCause.OTHER_ARMING),
    "a command without an arming": (command(arming_id=0), GateCause.OTHER_ARMING),
    "a first code below the range": (codes(819, 2048, 2048), GateCause.OUT_OF_RANGE),
    "a second code above the range": (codes(2048, 3277, 2048), GateCause.OUT_OF_RANGE),
    "a third code below the range": (codes(2048, 2048, 819), GateCause.OUT_OF_RANGE),
    "a code of zero": (codes(0, 2048, 2048), GateCause.OUT_OF_RANGE),
    "a force just past its limit": (FINE._replace(force_n=math.nextafter(420.0, 421.0)), GateCause.FORCE_ABOVE_LIMIT),
    "a negative force just past its limit": (FINE._replace(force_n=math.nextafter(-420.0, -421.0)), GateCause.FORCE_ABOVE_LIMIT),
    "an unknown force": (FINE._replace(force_n=math.nan), GateCause.FORCE_ABOVE_LIMIT),
    "an infinite force": (FINE._replace(force_n=math.inf), GateCause.FORCE_ABOVE_LIMIT),
    "a force count below the gauge": (FINE._replace(force_counts=-1), GateCause.FORCE_INVALID),
    "a saturated force count": (FINE._replace(force_counts=518), GateCause.FORCE_INVALID),
    "an emergency stop": (FINE._replace(estop=True), GateCause.ESTOP),
    "a plant that was delayed by more than a lease": (FINE._replace(overrun=True), GateCause.OVERRUN),
}
REVOKES_WHILE_SHUT = {
    GateCause.IMPOSSIBLE_ECHO,
    GateCause.OUT_OF_RANGE,
    GateCause.BEYOND_SLEW,
    GateCause.FORCE_INVALID,
    GateCause.FORCE_ABOVE_LIMIT,
    GateCause.ESTOP,
    GateCause.OVERRUN,
    GateCause.LINK_FAULTS,
    GateCause.TWO_PUBLISHERS,
}


def test_the_gate_is_silent_at_boot():
    memory = GateMemory()
    assert memory == GateMemory(
        state=int(GateState.SHUT),
        cause=int(GateCause.NO_PERMIT),
        codes=ZERO,
        command_number=-1,
        open_samples=0,
        arming_id=0,
        permit_epoch=0,
        command_epoch=0,
        revoked=(0,) * 16,
        recover_signs=NO_SIGNS,
    )
    assert step(memory, NOTHING_OBSERVED) == memory


def test_what_is_absent_permits_nothing_by_any_field():
    assert (False, 0, 0, int(Mode.DISARMED), -1, NO_SIGNS) == NO_PERMIT_OBSERVATION
    assert NO_COMMAND_OBSERVATION == (False, 0, 0, -1, -1, ZERO)


def test_it_opens_when_everything_holds_and_binds_arming_and_epochs():
    memory = step(GateMemory(), FINE)
    assert memory == GateMemory(
        state=int(GateState.OPEN),
        cause=int(GateCause.NONE),
        codes=ZERO,
        command_number=100,
        open_samples=1,
        arming_id=ARMING_ID,
        permit_epoch=SUPERVISOR,
        command_epoch=CONTROLLER,
        revoked=(0,) * 16,
        recover_signs=NO_SIGNS,
    )


@pytest.mark.parametrize("observed", HOLDS.values(), ids=HOLDS)
@pytest.mark.parametrize("before", [GateMemory(), opened()], ids=["shut", "open"])
def test_at_its_limit_a_condition_still_holds(before, observed):
    after = step(before, observed, AT_ONCE)
    assert (after.state, after.cause, after.codes) == (GateState.OPEN, GateCause.NONE, observed.command.codes)


@pytest.mark.parametrize(("observed", "cause"), BROKEN.values(), ids=BROKEN)
def test_just_past_its_limit_a_condition_cuts_to_zero_current_and_revokes(observed, cause):
    moving = step(opened(), codes(2100, 2000, 2048))
    after = step(moving, observed)
    assert (after.cause, after.codes, after.revoked[0]) == (cause, ZERO, ARMING_ID)
    assert (after.arming_id, after.permit_epoch, after.command_epoch, after.open_samples) == (0, 0, 0, 0)
    assert after.state == (
        GateState.REVOKED if observed.permit.present and observed.permit.arming_id == ARMING_ID else GateState.SHUT
    )
    assert step(after, FINE).cause == GateCause.REVOKED_ARMING


@pytest.mark.parametrize(("observed", "cause"), BROKEN.values(), ids=BROKEN)
def test_a_shut_gate_stays_shut_and_revokes_only_on_what_is_ours_but_wrong(observed, cause):
    after = step(GateMemory(), observed)
    wrong = cause in REVOKES_WHILE_SHUT and observed.permit.arming_id != 0
    assert (after.cause, after.codes) == (cause, ZERO)
    assert after.revoked == ((ARMING_ID,) + (0,) * 15 if wrong else (0,) * 16)
    assert after.state == (GateState.REVOKED if wrong else GateState.SHUT)
    assert step(after, FINE).state == (GateState.REVOKED if wrong else GateState.OPEN)


def test_an_emergency_stop_without_an_arming_revokes_nothing():
    stopped = step(GateMemory(), NOTHING_OBSERVED._replace(estop=True))
    assert (stopped.state, stopped.cause, stopped.revoked) == (GateState.SHUT, GateCause.ESTOP, (0,) * 16)
    absent = step(GateMemory(), permit(present=False, arming_id=0)._replace(estop=True))
    assert (absent.state, absent.revoked) == (GateState.SHUT, (0,) * 16)


def test_the_emergency_stop_is_named_before_every_other_cause():
    everything = FINE._replace(
        permit=NO_PERMIT_OBSERVATION, command=NO_COMMAND_OBSERVATION, estop=True, overrun=True, force_n=math.nan
    )
    assert step(opened(), everything).cause == GateCause.ESTOP
    assert step(opened(), everything._replace(estop=False)).cause == GateCause.OVERRUN


@pytest.mark.parametrize(
    ("observed", "cause"),
    [(permit(epoch=SUPERVISOR + 1), GateCause.EPOCH_CHANGED), (command(epoch=CONTROLLER + 1), GateCause.EPOCH_CHANGED)],
    ids=["supervisor", "controller"],
)
def test_a_bound_sender_that_changes_epoch_is_a_cut(observed, cause):
    after = step(opened(), observed)
    assert (after.state, after.cause, after.codes) == (GateState.REVOKED, cause, ZERO)
    assert step(GateMemory(), observed).state == GateState.OPEN  # unbound, it is free to be any


def test_a_permit_of_another_arming_cuts_and_opens_only_at_the_next_judgement():
    both = FINE._replace(permit=PERMIT._replace(arming_id=OTHER), command=COMMAND._replace(arming_id=OTHER))
    after = step(opened(), both)
    assert (after.state, after.cause, after.codes, after.revoked[0]) == (GateState.SHUT, GateCause.OTHER_ARMING, ZERO, ARMING_ID)
    again = step(after, both)
    assert (again.state, again.arming_id) == (GateState.OPEN, OTHER)


@pytest.mark.parametrize("link", [0, 1, 2])
@pytest.mark.parametrize("direction", [-1, 1])
def test_a_command_may_move_by_the_slew_limit_and_not_by_one_more(link, direction):
    limits = LIMITS._replace(tight_samples=0, slew_codes=300)

    def moved(by):
        return codes(*(2048 + (direction * by if i == link else 0) for i in range(3)))

    first = step(opened(limits=limits), moved(300), limits)
    assert first.codes[link] == 2048 + direction * 300
    assert step(opened(limits=limits), moved(301), limits).cause == GateCause.BEYOND_SLEW
    assert step(first, moved(600), limits).codes[link] == 2048 + direction * 600  # from what was accepted last
    assert step(first, moved(601), limits).cause == GateCause.BEYOND_SLEW
    assert step(first, moved(-1), limits).cause == GateCause.BEYOND_SLEW


def test_the_tight_slew_holds_for_twenty_samples_and_then_no_longer():
    beyond = codes(2048 + 101, 2048, 2048)
    assert step(GateMemory(), codes(2148, 1948, 2048)).codes == (2148, 1948, 2048)
    assert step(GateMemory(), beyond).cause == GateCause.BEYOND_SLEW
    assert step(opened(19), beyond).cause == GateCause.BEYOND_SLEW
    assert step(opened(20), beyond).codes == (2149, 2048, 2048)


def test_only_the_regular_instant_counts_as_a_sample():
    memory = opened()
    assert step(memory, FINE, at_latch=False).open_samples == 1
    assert step(memory, FINE).open_samples == 2
    assert step(GateMemory(), FINE, at_latch=False).open_samples == 0


def test_a_held_command_stays_in_force_inside_its_lease():
    memory = step(opened(), codes(2100, 2000, 2048))
    assert step(memory, command(codes=(2100, 2000, 2048), age_ns=TTL)).codes == (2100, 2000, 2048)


def test_recovering_allows_the_unloading_sign_at_low_current_and_nothing_else():
    at_limit = step(step(GateMemory(), recovering(2048, 1948, 2048)), recovering(2048, 1848, 2048))
    assert (at_limit.state, at_limit.codes, at_limit.recover_signs) == (GateState.RECOVERING, (2048, 1848, 2048), (0, -1, 0))
    low = step(GateMemory(), recovering(2048, 1348, 2048), AT_ONCE)
    assert (low.state, low.codes) == (GateState.RECOVERING, (2048, 1348, 2048))
    assert step(GateMemory(), recovering(2048, 2047, 2048), AT_ONCE).state == GateState.RECOVERING
    assert step(GateMemory(), recovering(*ZERO), AT_ONCE).state == GateState.RECOVERING


@pytest.mark.parametrize(
    "values", [(2048, 1347, 2048), (2048, 2049, 2048), (2049, 2048, 2048), (2048, 2048, 2047), (2047, 1948, 2048)]
)
def test_recovering_refuses_more_current_the_loading_sign_and_every_other_link(values):
    after = step(GateMemory(), recovering(*values), AT_ONCE)
    assert (after.state, after.cause, after.codes) == (GateState.REVOKED, GateCause.NOT_UNLOADING, ZERO)
    during = step(step(GateMemory(), recovering(*ZERO), AT_ONCE), recovering(*values), AT_ONCE)
    assert (during.state, during.cause, during.codes, during.recover_signs) == (
        GateState.REVOKED,
        GateCause.NOT_UNLOADING,
        ZERO,
        NO_SIGNS,
    )


def test_recovering_is_a_permission_that_ages_like_any_other():
    late = recovering(*ZERO)._replace(permit=UNLOAD_UP._replace(age_ns=TTL + 1))
    assert step(step(GateMemory(), recovering(*ZERO)), late).cause == GateCause.PERMIT_STALE


def test_a_permit_that_runs_shows_no_recovery_signs():
    assert step(GateMemory(), permit(recover_signs=(1, 1, 1))).recover_signs == NO_SIGNS
