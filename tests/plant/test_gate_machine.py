"""Random permits, commands, forces and interruptions: what the gate never does."""

from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from hydrohil.services.plant.gate import CommandObservation, GateInput, GateMemory, PermitObservation, gate_step
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.contract.messages import GateState, Mode
from tests.support.gate_scene import COMMAND, FINE, LIMITS, PERMIT, TTL, ZERO

ARMING_IDS = st.sampled_from([0, 1, 2, 3, 4])
EPOCHS = st.sampled_from([11, 12])
AGES = st.sampled_from([-1, 0, TTL, TTL + 1])
CODES = st.sampled_from([819, 820, 1948, 2000, 2047, 2048, 2049, 2100, 2148, 2149, 3276, 3277])
FORCES = st.sampled_from([0.0, 420.0, 420.1, -421.0, float("nan"), float("inf")])
COUNTS = st.sampled_from([-1, 0, 10, 517, 518])
TICKS = st.sampled_from([-(2**31), -1, 0, 7])
SIGNS = st.tuples(*[st.sampled_from([-1, 0, 1])] * 3)
PERMITS = st.builds(PermitObservation, st.booleans(), ARMING_IDS, EPOCHS, st.sampled_from([int(m) for m in Mode]), AGES, SIGNS)
COMMANDS = st.builds(
    CommandObservation, st.booleans(), ARMING_IDS, EPOCHS, AGES, st.integers(-1, 9), st.tuples(CODES, CODES, CODES)
)
FAULTS = st.sampled_from([0, 0, 0, 1, 2, 8])
ANYTHING = st.builds(GateInput, PERMITS, COMMANDS, COUNTS, FORCES, TICKS, st.booleans(), st.booleans(), FAULTS, FAULTS)
LIMITS_DRAWN = st.sampled_from([LIMITS, LIMITS._replace(tight_samples=0), LIMITS._replace(tight_samples=0, slew_codes=1)])
gate_step_compiled = compiled(gate_step)


def everything_holds(observed):
    """The specification once more, in other words than the gate's."""
    permit, command = observed.permit, observed.command
    may_run = (
        permit.mode == Mode.RUNNING
        and observed.tick >= 0
        and 0 <= observed.force_counts < 518
        and -420.0 <= observed.force_n <= 420.0
    )
    unloads = permit.mode == Mode.RECOVER and all(
        code == 2048 or 0 < (code - 2048) * sign <= 700 for code, sign in zip(command.codes, permit.recover_signs, strict=True)
    )
    return (
        permit.present
        and command.present
        and permit.arming_id == command.arming_id != 0
        and 0 <= permit.age_ns <= TTL
        and 0 <= command.age_ns <= TTL
        and all(820 <= code <= 3276 for code in command.codes)
        and not observed.estop
        and not observed.overrun
        and observed.link_faults < 2
        and observed.epoch_conflicts < 2
        and (may_run or unloads)
    )


class GateUnderFire(RuleBasedStateMachine):
    """A gate between a supervisor and a controller that do anything at all."""

    @initialize()
    def boot(self):
        self.memory, self.before, self.observed = GateMemory(), GateMemory(), None
        self.dead = set()  # armings that a cut has revoked, never forgotten here

    @rule(observed=ANYTHING, at_latch=st.booleans())
    def judge_anything(self, observed, at_latch):
        self._judge(observed, at_latch)

    @rule(
        arming_id=st.integers(1, 12), mode=st.sampled_from([2, 4]), codes=st.tuples(CODES, CODES, CODES), times=st.integers(1, 25)
    )
    def run_well(self, arming_id, mode, codes, times):
        permit = PERMIT._replace(arming_id=arming_id, mode=mode, recover_signs=(1, -1, 1))
        for _ in range(times):
            self._judge(FINE._replace(permit=permit, command=COMMAND._replace(arming_id=arming_id)), True)
        self._judge(FINE._replace(permit=permit, command=COMMAND._replace(arming_id=arming_id, codes=codes)), True)

    @rule(arming_id=st.integers(1, 12), epoch=EPOCHS)
    def change_an_epoch(self, arming_id, epoch):
        self._judge(FINE._replace(permit=PERMIT._replace(arming_id=arming_id, epoch=epoch)), True)

    @rule()
    def go_absent(self):
        self._judge(FINE._replace(permit=PERMIT._replace(present=False)), True)

    def _judge(self, observed, at_latch):
        self.before, self.observed = self.memory, observed
        self.memory = gate_step(self.memory, LIMITS, observed, at_latch)
        was_open = self.before.state in (GateState.OPEN, GateState.RECOVERING)
        if was_open and self.memory.cause:
            self.dead.add(self.before.arming_id)
        self.check()

    def check(self):
        is_open = self.memory.state in (GateState.OPEN, GateState.RECOVERING)
        assert is_open == (self.memory.cause == 0) == (self.memory.arming_id != 0)
        if self.memory.codes != ZERO or is_open:
            assert is_open
            assert everything_holds(self.observed)
            assert self.memory.arming_id == self.observed.permit.arming_id not in self.dead
            assert self.memory.codes == self.observed.command.codes
            slew = LIMITS.slew_codes if self.before.open_samples >= LIMITS.tight_samples else LIMITS.tight_slew_codes
            assert max(abs(a - b) for a, b in zip(self.memory.codes, self.before.codes, strict=True)) <= slew
        if is_open and self.before.arming_id:
            assert self.memory.arming_id == self.before.arming_id
            assert (self.memory.permit_epoch, self.memory.command_epoch) == (self.before.permit_epoch, self.before.command_epoch)
        if is_open and not self.before.arming_id:
            assert max(abs(code - 2048) for code in self.memory.codes) <= LIMITS.tight_slew_codes

    @invariant()
    def a_shut_gate_writes_zero_and_is_bound_to_nobody(self):
        if self.memory.state in (GateState.SHUT, GateState.REVOKED):
            assert (self.memory.codes, self.memory.arming_id, self.memory.open_samples) == (ZERO, 0, 0)


GateUnderFire.TestCase.settings = settings(max_examples=60, stateful_step_count=30, deadline=None)
TestGateUnderFire = GateUnderFire.TestCase


@settings(max_examples=300, deadline=None)
@given(st.lists(ANYTHING, min_size=1, max_size=4), LIMITS_DRAWN, st.booleans())
def test_plain_and_compiled_gates_agree_on_anything(inputs, limits, at_latch):
    plain = machine = gate_step(GateMemory(), limits, FINE, True)
    for observed in inputs:
        plain = gate_step(plain, limits, observed, at_latch)
        machine = gate_step_compiled(machine, limits, observed, at_latch)
        assert tuple(machine) == plain
