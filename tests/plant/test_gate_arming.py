import pytest

from hydrohil.services.plant.gate import NO_PERMIT_OBSERVATION, GateMemory
from hydrohil.shared.contract.messages import GateCause, GateState, Mode
from tests.support.gate_scene import ARMING_ID, FINE, NO_SIGNS, OTHER, TTL, ZERO, armed_anew, command, opened, permit, step


def cut(memory):
    return step(memory, FINE._replace(permit=NO_PERMIT_OBSERVATION))


def test_permission_is_lost_by_absence():
    after = cut(opened())
    assert (after.state, after.cause, after.codes) == (GateState.SHUT, GateCause.NO_PERMIT, ZERO)


@pytest.mark.parametrize("renewed", [FINE, permit(age_ns=0), command(age_ns=0), FINE._replace(force_n=0.0)])
def test_nothing_resumes_by_itself_after_a_stale_command(renewed):
    after = step(opened(), command(age_ns=TTL + 1))
    for _ in range(50):
        after = step(after, renewed)
        assert (after.state, after.cause, after.codes) == (GateState.REVOKED, GateCause.REVOKED_ARMING, ZERO)


def test_a_new_arming_opens_after_a_cut():
    after = step(cut(opened()), armed_anew(OTHER))
    assert (after.state, after.arming_id) == (GateState.OPEN, OTHER)


def test_each_of_the_last_sixteen_revoked_armings_stays_shut():
    memory = GateMemory()
    for arming_id in range(1, 17):
        memory = cut(step(memory, armed_anew(arming_id)))
    assert memory.revoked == tuple(range(16, 0, -1))
    for arming_id in range(1, 17):
        assert step(memory, armed_anew(arming_id)).cause == GateCause.REVOKED_ARMING


def test_a_revoked_arming_that_is_shown_again_is_not_revoked_twice():
    memory = cut(opened())
    for _ in range(20):
        memory = step(memory, FINE._replace(estop=True))
    assert memory.revoked == (ARMING_ID,) + (0,) * 15


def test_what_a_shut_gate_revokes_pushes_the_older_numbers_back():
    memory = step(cut(opened()), armed_anew(OTHER, force_n=500.0))
    assert memory.revoked == (OTHER, ARMING_ID) + (0,) * 14


def test_recovering_and_running_revoke_alike():
    recovering = FINE._replace(permit=FINE.permit._replace(mode=4, recover_signs=(0, 0, -1)))
    memory = step(GateMemory(), recovering)
    assert memory.state == GateState.RECOVERING
    after = cut(memory)
    assert (after.revoked[0], after.recover_signs) == (ARMING_ID, NO_SIGNS)
    assert step(after, recovering).cause == GateCause.REVOKED_ARMING


@pytest.mark.parametrize(("first", "then"), [(Mode.RUNNING, Mode.RECOVER), (Mode.RECOVER, Mode.RUNNING)])
def test_an_arming_is_good_for_one_mode_only(first, then):
    def observed(mode):
        return FINE._replace(permit=FINE.permit._replace(mode=int(mode), recover_signs=(0, 0, -1)))

    memory = step(step(GateMemory(), observed(first)), observed(first))
    assert memory.state in (GateState.OPEN, GateState.RECOVERING)
    memory = step(memory, observed(then))
    assert (memory.cause, memory.codes) == (GateCause.OTHER_ARMING, ZERO)
    assert step(memory, observed(first)).cause == GateCause.REVOKED_ARMING


def test_the_number_of_a_refused_command_is_still_reported():
    assert step(GateMemory(), command(arming_id=OTHER, number=321)).command_number == 321


def test_stopping_without_an_arming_pushes_no_revoked_number_out():
    memory = cut(opened())
    for _ in range(20):
        memory = step(memory, armed_anew(0, estop=True))
    assert memory.revoked == (ARMING_ID,) + (0,) * 15
