"""Supervisor and gate together: every sequence of samples x events up to a length, by walking every state that can be reached.

Each step is one sample: `supervisor_step` judges it, `gate_step` judges the permit at the latch, and the next sample reports
what the gate did. States that are equal have equal futures and are walked once: no sequence is left out.
"""

from itertools import product
from typing import NamedTuple

import pytest

from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.gate import CommandObservation, GateInput, GateMemory, PermitObservation, gate_step
from hydrohil.services.supervisor.modes import Event
from hydrohil.services.supervisor.observe import SampleContext, observe_step
from hydrohil.services.supervisor.rules import first_broken
from hydrohil.services.supervisor.state import SupervisorMemory
from hydrohil.services.supervisor.step import supervisor_step
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL, GateState, Mode
from tests.support.supervisor_scene import DESCRIPTION, LEVEL, PARAMS, asked, sample

LIMITS = GateLimits()
ZERO = (2048, 2048, 2048)
NOW = PARAMS._replace(observer=PARAMS.observer._replace(tare_ticks=0), lead_samples=1, recover_samples=1)
BEYOND = (
    LEVEL[0],
    round((0.6 - DESCRIPTION.machine.encoders[1].offset) / DESCRIPTION.machine.encoders[1].scale),
    *LEVEL[2:],
)  # link 2 past its 27 deg


class Flags(NamedTuple):
    """What is wrong in one sample; at most two at once."""

    force: bool = False  # raw and tared force above the supervisor's limits, and above the gate's
    joint: bool = False
    lost: bool = False  # nine samples are missing before this one
    controller: bool = False  # not ready, and its command does not come
    disagreed: bool = False
    pressed: bool = False  # emergency stop at the gate


WRONG = [flags for flags in (Flags(*values) for values in product((False, True), repeat=6)) if sum(flags) <= 2]
STEPS = list(product(WRONG, Event))
ONE_AT_ONCE = [step for step in STEPS if sum(step[0]) <= 1]


class Walked(NamedTuple):
    """Both memories, and what an operator has done since permission was lost."""

    supervisor: SupervisorMemory
    gate: GateMemory
    acts: tuple[Event, ...] = ()  # ARM and START, in the order they came, since the last trip, cut or disarming


BOOT = Walked(SupervisorMemory(), GateMemory())


def sampled(state, number, flags):
    """The sample `number`: the gate as it was left, the trial's tick as the permit announced it."""
    memory, gate = state
    begun = memory.mode == Mode.RUNNING and memory.first_sample != NO_COMMAND and number >= memory.first_sample
    changes = {"force_counts": 400} if flags.force else {}
    if flags.joint:
        changes["encoder_counts"] = BEYOND
    tick = number - memory.first_sample if begun else NO_TRIAL
    return sample(number, tick, gate=gate.state, gate_cause=gate.cause, dac_counts=gate.codes, **changes)


def judged(current, memory, arming_id, permit, flags):
    """What the gate does with the permit and an answer of the same arming."""
    unloads = permit.mode == Mode.RECOVER
    codes = tuple(2048 + 12 * (sign if unloads else 1) for sign in permit.recover_signs)
    of_permit = PermitObservation(True, arming_id, 1, permit.mode, 4_000_000, permit.recover_signs)
    command = CommandObservation(not flags.controller, arming_id, 2, 4_000_000, current.number, codes)
    force_n = current.force_counts * PARAMS.observer.calibration.force_n_per_count
    return gate_step(
        memory,
        LIMITS,
        GateInput(
            permit=of_permit,
            command=command,
            force_counts=current.force_counts,
            force_n=force_n,
            tick=current.tick,
            estop=flags.pressed,
            overrun=False,
            link_faults=0,
            epoch_conflicts=0,
        ),
        True,
    )


def judged_by_rules(memory, current, inputs):
    context = SampleContext(memory.mode == Mode.RUNNING, inputs.stale_ns, inputs.controller_ready, inputs.links)
    return observe_step(memory.observer, NOW.observer, current, context)[1]


def stepped(state, number, flags, event):
    """Both memories after one sample, the sample, and what the rules say of it."""
    if flags.lost:
        state = state._replace(
            supervisor=state.supervisor._replace(observer=state.supervisor.observer._replace(last_number=number - 10))
        )
    current = sampled(state[:2], number, flags)
    inputs = asked(event, new_arming_id=number, agreed=not flags.disagreed, controller_ready=not flags.controller)
    broken = first_broken(judged_by_rules(state.supervisor, current, inputs), NOW.limits)[0]
    supervisor, permit = supervisor_step(state.supervisor, NOW, current, inputs)
    return supervisor, judged(current, state.gate, supervisor.arming_id, permit, flags), current, broken


def acts_after(state, supervisor, gate, event):
    """The operator's acts that count: every trip, cut and disarming forgets them."""
    if supervisor.mode in (Mode.TRIPPED, Mode.DISARMED) or gate.state == GateState.REVOKED:
        return ()
    new = event in (Event.ARM, Event.START) and event not in state.acts and (event == Event.ARM or Event.ARM in state.acts)
    return (*state.acts, event) if new else state.acts


def check(before, after, flags, event, current, broken):
    """Current only if everything that may stop it is quiet, and an operator has led there step by step."""
    supervisor, gate, acts = after
    flows = gate.codes != ZERO
    assert flows == (gate.state in (GateState.OPEN, GateState.RECOVERING))
    if not flows:
        return
    assert not (flags.pressed or flags.controller) and event not in (Event.ESTOP, Event.STOP)
    assert gate.arming_id == supervisor.arming_id != 0
    assert gate.arming_id not in before.gate.revoked
    assert event != Event.RESET or gate == stepped(before, current.number, flags, Event.NOTHING)[1]  # a reset moves nothing
    if supervisor.mode == Mode.RUNNING:
        assert (broken, flags.force, flags.joint, flags.lost) == (0, False, False, False)
        assert current.tick >= 0
        assert [act for act in acts if act in (Event.ARM, Event.START)][:2] == [Event.ARM, Event.START]
    else:
        assert supervisor.mode == Mode.RECOVER
        assert before.supervisor.mode in (Mode.TRIPPED, Mode.RECOVER)
        assert event in (Event.HOLD_RECOVER, Event.NOTHING)
        assert all(code == 2048 or (code - 2048) * sign > 0 for code, sign in zip(gate.codes, gate.recover_signs, strict=True))


def walk(starts, steps, length, number=100):
    """Every state that sequences of this length reach; each step is checked. Gives the states and the steps taken."""
    reached, taken = set(starts), 0
    for _ in range(length):
        following = set()
        for state in reached:
            for flags, event in steps:
                supervisor, gate, current, broken = stepped(state, number, flags, event)
                after = Walked(supervisor, gate, acts_after(state, supervisor, gate, event))
                check(state, after, flags, event, current, broken)
                following.add(after)
                taken += 1
        reached, number = following, number + 1
    return reached, taken


def led(*steps, number=90):
    """The state after these steps from the start, at the sample before 100."""
    state = BOOT
    for flags, event in [(Flags(), Event.NOTHING)] * (10 - len(steps)) + list(steps):
        supervisor, gate, _, _ = stepped(state, number, flags, event)
        state, number = Walked(supervisor, gate, acts_after(state, supervisor, gate, event)), number + 1
    return state


QUIET = [(Flags(), event) for event in (Event.ARM, Event.START, Event.NOTHING, Event.NOTHING)]
RUNNING = led(*QUIET)
FORCED = led(*QUIET, (Flags(force=True), Event.NOTHING))
STARTS = (
    BOOT,
    RUNNING,
    FORCED,
    led(*QUIET, (Flags(joint=True), Event.NOTHING)),
    led(*QUIET, (Flags(pressed=True), Event.NOTHING)),
)


def test_the_starts_are_what_they_are_called():
    assert (RUNNING.supervisor.mode, RUNNING.gate.state) == (Mode.RUNNING, GateState.OPEN)
    assert (FORCED.supervisor.mode, FORCED.gate.codes, FORCED.acts) == (Mode.TRIPPED, ZERO, ())


@pytest.mark.parametrize(
    ("steps", "length"),
    [(ONE_AT_ONCE, 3), (STEPS, 2), *(pytest.param(*deep, marks=pytest.mark.slow) for deep in ((ONE_AT_ONCE, 4), (STEPS, 3)))],
    ids=["one flag, length 3", "two flags, length 2", "one flag, length 4", "two flags, length 3"],
)
def test_in_every_sequence_current_flows_only_with_everything_quiet_and_every_act_done(steps, length):
    reached, taken = walk(STARTS, steps, length)
    assert {state.supervisor.mode for state in reached} == set(map(int, Mode))
    assert {GateState.OPEN, GateState.RECOVERING, GateState.REVOKED, GateState.SHUT} == {state.gate.state for state in reached}
    assert taken >= len(steps) * len(STARTS) * length


@pytest.mark.parametrize("flag", Flags._fields)
def test_each_flag_alone_stops_a_running_trial_in_the_same_sample_or_the_next(flag):
    state = RUNNING
    for number in (100, 101):
        supervisor, gate, _, _ = stepped(state, number, Flags()._replace(**{flag: True}), Event.NOTHING)
        state = Walked(supervisor, gate)
    assert (state.gate.codes == ZERO) == (
        flag != "disagreed"
    )  # who disagrees once it runs is the gate's to see, by epoch and run
    assert (state.supervisor.mode == Mode.TRIPPED) == (flag != "disagreed")
