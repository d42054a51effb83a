"""Every combination of the gate's conditions: current only if all of them hold.

Exhaustive with `-m slow`: 2^20 inputs (eighteen conditions, each met or not, and four kinds of codes) in every mode and for
every state of the gate. Without it: of these, all that break at most two conditions of the permit and two of the command,
with all 2^7 of the rest, for RUNNING and RECOVER. Values stand on and just past limits.
"""

from itertools import product

import pytest

from hydrohil.services.plant.gate import GateInput, GateMemory, gate_step
from hydrohil.shared.contract.messages import GateCause, GateState, Mode
from tests.support.gate_scene import ARMING_ID, COMMAND, CONTROLLER, FINE, LIMITS, OTHER, PERMIT, SUPERVISOR, TTL, ZERO

OPEN = (GateState.OPEN, GateState.RECOVERING)
SIGNS = (0, -1, 0)
TIGHT = LIMITS.tight_slew_codes
LAST = (2048, 2028, 2048)  # at the D/A of an open gate
GOOD, TOO_FAR, LOADING, OUTSIDE = (2048, 1948, 2048), (2048, 1927, 2048), (2048, 2049, 2048), (2048, 819, 2048)
REVOKED = (ARMING_ID,) + (0,) * 15
FRESH = GateMemory()
RUN = GateMemory(
    state=int(GateState.OPEN),
    cause=0,
    codes=LAST,
    command_number=99,
    open_samples=3,
    arming_id=ARMING_ID,
    permit_epoch=SUPERVISOR,
    command_epoch=CONTROLLER,
)
RECOVERING = RUN._replace(state=int(GateState.RECOVERING), recover_signs=SIGNS)


def permits(mode):
    """(holds, permit): present, arming other than 0, arming that was bound, echo known, echo fresh, epoch that was bound."""
    for present, armed, bound, known, fresh, epoch in product((True, False), repeat=6):
        arming_id = (ARMING_ID if bound else OTHER) if armed else 0
        age = -1 if not known else TTL if fresh else TTL + 1
        holds = present, armed, bound, known, fresh or not known, epoch
        yield (
            holds,
            PERMIT._replace(
                present=present,
                mode=int(mode),
                arming_id=arming_id,
                age_ns=age,
                epoch=SUPERVISOR + (not epoch),
                recover_signs=SIGNS,
            ),
        )


def commands():
    """(holds, command): present, arming of the first permit, echo known, echo fresh, epoch that was bound, codes allowed."""
    flags = product((True, False), (True, False), (True, False), (True, False), (True, False), (GOOD, TOO_FAR, LOADING, OUTSIDE))
    for present, same, known, fresh, epoch, codes in flags:
        age = -1 if not known else TTL if fresh else TTL + 1
        yield (
            (present, same, known, fresh or not known, epoch, codes),
            COMMAND._replace(
                present=present, arming_id=ARMING_ID if same else OTHER, age_ns=age, epoch=CONTROLLER + (not epoch), codes=codes
            ),
        )


def circumstances():
    """(holds, rest): force valid, force below, tick 0 or later, no emergency stop, no overrun, clean links, one publisher."""
    for holds in product((True, False), repeat=7):
        valid, below, begun, released, awake, clean, alone = holds
        rest = 10 if valid else 518, 420.0 if below else 420.1, 0 if begun else -1, not released, not awake
        yield holds, {**dict(zip(CIRCUMSTANCES, rest, strict=False)), "link_faults": 2 - clean, "epoch_conflicts": 2 - alone}


CIRCUMSTANCES = ("force_counts", "force_n", "tick", "estop", "overrun")
REST = [(holds, FINE._replace(**rest)) for holds, rest in circumstances()]


def chosen(messages, at_most):
    """Those of (holds, message) in which at most so many conditions are broken."""
    return [(holds, message) for holds, message in messages if sum(held is False for held in holds) <= at_most]


def may_open(memory, mode, of_permit, of_command, rest, revoked):
    """The rule in other words: all of these, whatever their order."""
    present, armed, bound, known, fresh, same_supervisor = of_permit
    there, same, command_known, command_fresh, same_controller, codes = of_command
    valid, below, begun, released, awake, clean, alone = rest
    was_open = memory.arming_id != 0
    held = (
        present
        and armed
        and known
        and fresh
        and there
        and command_known
        and command_fresh
        and released
        and awake
        and clean
        and alone
    )
    agree = (bound if same else not bound) and not revoked
    unchanged = not was_open or (bound and same_supervisor and same_controller)
    if mode == Mode.RUNNING:
        near = codes != OUTSIDE and abs(codes[1] - memory.codes[1]) <= TIGHT
        return held and agree and unchanged and near and valid and below and begun and memory.state != GateState.RECOVERING
    near = codes == GOOD or (codes == TOO_FAR and abs(codes[1] - memory.codes[1]) <= TIGHT)
    return mode == Mode.RECOVER and held and agree and unchanged and near and memory.state != GateState.OPEN


def opened_against_the_rule(memory, mode, at_most):
    """Steps on which gate and rule differ, and how many opened."""
    wrong, opened = [], 0
    for of_permit, permit in chosen(permits(mode), at_most):
        for of_command, command in chosen(commands(), at_most):
            for rest, around in REST:
                observed = GateInput(permit, command, *around[2:])
                after = gate_step(memory, LIMITS, observed, True)
                revoked = permit.arming_id in memory.revoked and permit.arming_id != 0
                is_open = after.codes != ZERO or after.state in OPEN
                opened += is_open
                if is_open != may_open(memory, mode, of_permit, of_command, rest, revoked) or (is_open and after.cause):
                    wrong.append((observed, after))
    return wrong, opened


@pytest.mark.parametrize(
    ("memory", "mode"),
    [(FRESH, Mode.RUNNING), (RUN, Mode.RUNNING), (FRESH, Mode.RECOVER), (RECOVERING, Mode.RECOVER)],
    ids=["shut, RUNNING", "open, RUNNING", "shut, RECOVER", "recovering, RECOVER"],
)
def test_current_flows_if_and_only_if_every_condition_holds(memory, mode):
    wrong, opened = opened_against_the_rule(memory, mode, 2)
    assert wrong == []
    assert opened > 0


@pytest.mark.slow
@pytest.mark.parametrize("mode", Mode)
@pytest.mark.parametrize(
    "memory",
    [FRESH, RUN, RECOVERING, FRESH._replace(revoked=REVOKED), GateMemory(int(GateState.REVOKED), 4, revoked=REVOKED)],
    ids=["shut", "open", "recovering", "shut after a cut", "revoked"],
)
def test_current_flows_if_and_only_if_every_condition_holds_in_every_mode_and_state(memory, mode):
    wrong, opened = opened_against_the_rule(memory, mode, 6)
    assert wrong == []
    open_in = {Mode.RUNNING: GateState.RECOVERING, Mode.RECOVER: GateState.OPEN}.get(mode)
    assert (opened > 0) == (open_in is not None and memory.state != open_in)


def test_any_cut_revokes_its_arming_whatever_was_broken():
    around = [FINE, FINE._replace(force_counts=518), FINE._replace(estop=True), FINE._replace(link_faults=2)]
    for memory, mode in ((RUN, Mode.RUNNING), (RECOVERING, Mode.RECOVER)):
        for _, permit in permits(mode):
            for rest in around:
                for _, command in commands():
                    cut = gate_step(memory, LIMITS, GateInput(permit, command, *rest[2:]), True)
                    if cut.codes == ZERO and cut.state not in OPEN:
                        assert ARMING_ID in cut.revoked
                        again = gate_step(cut, LIMITS, FINE, True)
                        assert (again.codes, again.cause) == (ZERO, GateCause.REVOKED_ARMING)


def test_a_gate_that_has_never_opened_is_at_zero():
    assert (FRESH.codes, FRESH.state, FINE.permit.present) == (ZERO, GateState.SHUT, True)
