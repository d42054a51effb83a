from types import SimpleNamespace

import pytest
from supervisor_scene import sample
from wire_scene import CELL, command_body, header, permit_body

from shared.codec import encode
from shared.detour import FOREVER_NS, Conditions, conditions_of, idle
from shared.envelope import seal, unseal
from shared.faults import Fault
from shared.inbox import RING, Inbox
from shared.messages import NO_TRIAL
from shared.topics import BY_KEY, expression
from shared.units import SUBSTEP_NS

PERIOD = 90
ZERO_NUMBER = 100  # sample of tick 0
LATE = Fault("delay", "controller>plant", value=9.0)


class Scene:
    """One inbox under faults, fed by hand."""

    def __init__(self, key, receiver, *faults, lockstep=True):
        self.key = key
        self.inbox = Inbox(BY_KEY[key], CELL, RING, lambda: None)
        self.conditions = Conditions(receiver, faults, seed=3, period=PERIOD, ticks=(-8, 400), lockstep=lockstep)
        self.conditions.see(ZERO_NUMBER, 0)
        self.inbox.impair(self.conditions)

    def put(self, tick, *, seq=None, body=None, echo_tick=None):
        number = ZERO_NUMBER + (tick if echo_tick is None else echo_tick)
        body = body or {"plant/sample": sample(number)._replace(tick=tick)}.get(self.key, command_body())
        head = header(self.key, number if seq is None else seq, echo_number=number, echo_time_ns=number * PERIOD * SUBSTEP_NS)
        frame = encode(expression(CELL, self.key), head, body)
        self.inbox.put(SimpleNamespace(payload=SimpleNamespace(to_bytes=lambda: frame)))

    def ticks(self, simulated_ns=FOREVER_NS):
        return [message.header.echo_number - ZERO_NUMBER for message in self.inbox.take(simulated_ns)]


def instant(tick, substeps=0):
    return ((ZERO_NUMBER + tick) * PERIOD + substeps) * SUBSTEP_NS


def test_a_way_that_no_fault_touches_is_left_alone():
    scene = Scene("controller/command", "plant", Fault("loss", "supervisor>plant", value=0.5))
    assert scene.inbox.detour is None


def test_a_late_command_comes_at_its_sub_step_of_simulated_time_and_nobody_waits_for_it():
    scene = Scene("controller/command", "plant", LATE)
    scene.put(5)
    assert scene.ticks(instant(5, 179)) == []
    assert scene.inbox.arrived() == ZERO_NUMBER + 5
    assert scene.ticks(instant(5, 180)) == [5]


def test_a_late_command_says_how_late():
    scene = Scene("controller/command", "plant", LATE, Fault("delay", "plant>controller", value=1.0))
    scene.put(5)
    (message,) = scene.inbox.take()
    assert scene.inbox.delay_ns(message) == 10_000_000


def test_a_lost_command_counts_as_arrived_and_never_comes():
    scene = Scene("controller/command", "plant", Fault("burst", "controller>plant", value=1.0))
    scene.put(0)
    assert scene.ticks() == []
    assert scene.inbox.arrived() == ZERO_NUMBER
    scene.put(1)
    assert scene.ticks() == [1]
    assert scene.inbox.acceptance.lost == 0  # the first of a stream: nothing was before it


def test_outside_a_trial_nothing_happens_to_a_frame():
    scene = Scene("controller/command", "plant", Fault("partition", "controller>plant"))
    scene.conditions.see(ZERO_NUMBER, NO_TRIAL)
    scene.put(3)
    assert scene.ticks(0) == [3]


def test_a_duplicate_is_discarded_and_counted():
    scene = Scene("controller/command", "plant", Fault("duplicate", "controller>plant", lasts_s=0.0045, value=1.0))
    scene.put(0)
    assert scene.ticks() == [0]
    assert scene.inbox.acceptance.discarded["sequence"] == 1


def test_an_overtaken_frame_comes_behind_its_successor_and_is_counted():
    scene = Scene("controller/command", "plant", Fault("reorder", "controller>plant", lasts_s=0.0045, value=1.0))
    scene.put(0)
    assert scene.ticks(instant(0, 80)) == []
    scene.put(1)
    assert scene.ticks(instant(1, 80)) == [1]
    assert scene.inbox.acceptance.discarded["sequence"] == 1


def test_a_turned_bit_is_caught_by_the_checksum():
    scene = Scene("controller/command", "plant", Fault("corrupt", "controller>plant", lasts_s=0.045, value=1.0))
    for tick in range(10):
        scene.put(tick)
    assert scene.ticks() == []
    assert scene.inbox.acceptance.discarded["crc"] == 10


def test_a_cut_takes_what_is_sent_again_on_an_old_sample_too():
    scene = Scene("supervisor/permit", "plant", Fault("partition", "supervisor>plant", 0.045))
    scene.put(9, body=permit_body())
    assert scene.ticks() == [9]
    scene.conditions.see(ZERO_NUMBER + 12, 12)
    scene.put(12, echo_tick=9, seq=999, body=permit_body())
    assert scene.ticks() == []


def test_a_cut_takes_every_topic_of_its_path():
    scene = Scene("plant/about", "supervisor", Fault("partition", "plant>supervisor"))
    assert scene.inbox.detour is not None
    passed = Inbox(BY_KEY["controller/passed"], CELL, RING, lambda: None)
    passed.impair(Conditions("plant", (Fault("partition", "controller>plant"),), seed=1, period=90, ticks=(0, 9), lockstep=True))
    assert passed.detour is None  # word of what a fault took is no message of the rig


def test_in_lockstep_a_lost_sample_is_told_and_a_late_one_answered_at_once():
    lost = Scene("plant/sample", "controller", Fault("burst", "plant>controller", value=1.0))
    lost.put(-1)
    lost.put(0)
    assert lost.ticks() == [-1]
    assert [(p.number, p.taken) for p in lost.inbox.passages()] == [(ZERO_NUMBER, False)]
    late = Scene("plant/sample", "controller", Fault("delay", "plant>controller", value=50.0))
    late.put(0)
    assert late.ticks() == [0]


def test_silence_is_simulated_time_since_the_newest_sample_that_had_come():
    scene = Scene("plant/sample", "supervisor", Fault("partition", "plant>supervisor"))
    for tick in (-2, -1, 0, 1):
        scene.put(tick)
    scene.ticks()
    assert [passage.silence_ns for passage in scene.inbox.passages()] == [4_500_000, 9_000_000]


def test_in_real_a_late_frame_waits_on_the_wall_clock_and_the_wake_up_is_known():
    scene = Scene("controller/command", "plant", LATE, lockstep=False)
    scene.put(5)
    assert scene.ticks() == []
    detour = scene.inbox.detour
    assert detour.released(0, detour.next_ns() - 1) == []
    (frame,) = detour.released(0, detour.next_ns())
    assert frame.arrival_ns > 0


def load(faults, clock="lockstep"):
    text = seal({"faults": faults}, run=1, seed=1, clock=clock, bias_ticks=8, duration_ticks=100)
    return conditions_of(unseal(text), idle("plant"))


def test_a_load_with_a_fault_that_its_clock_cannot_play_is_refused():
    kill = {"kind": "kill", "target": "controller", "at_s": 0.1}
    assert load([kill], "real").service == "plant"
    with pytest.raises(ValueError, match="cannot be played on the lockstep clock"):
        load([kill])
    with pytest.raises(ValueError, match="kind is 'explode'"):
        load([kill | {"kind": "explode"}], "real")


def test_a_load_with_a_fault_that_would_never_act_or_says_no_value_is_refused():
    burst = {"kind": "burst", "target": "controller>plant", "value": 1.0}
    assert load([burst | {"at_s": 99 * 0.0045}]).service == "plant"
    with pytest.raises(ValueError, match=r"faults.0: burst of controller>plant begins at 0.45 s, but the trial ends at 0.45 s"):
        load([burst | {"at_s": 100 * 0.0045}])
    with pytest.raises(ValueError, match=r"faults.1: value of loss is missing"):
        load([burst, {"kind": "loss", "target": "controller>plant"}])


def test_lockstep_is_refused_while_something_injected_acts():
    before = idle("plant")
    before.inject(((Fault("loss", "controller>plant", value=0.1), 7),))
    with pytest.raises(ValueError, match="inject --clear"):
        conditions_of(unseal(seal({}, run=1, seed=1, clock="lockstep", bias_ticks=8, duration_ticks=100)), before)
    kept = conditions_of(unseal(seal({}, run=1, seed=1, clock="real", bias_ticks=8, duration_ticks=100)), before)
    assert kept.by_hand == before.by_hand


def test_what_is_injected_by_hand_begins_with_the_next_sample_in_a_trial_or_outside():
    scene = Scene("controller/command", "plant", lockstep=False)
    assert scene.inbox.detour is None
    scene.conditions.see(ZERO_NUMBER + 4, NO_TRIAL)
    scene.conditions.inject(((Fault("burst", "controller>plant", value=2.0), ZERO_NUMBER + 4),))
    scene.inbox.impair(scene.conditions)
    assert len(scene.conditions.lasting()) == 1
    for tick in range(4, 9):
        scene.put(tick)
    assert scene.ticks() == [4, 7, 8]
    assert scene.conditions.lasting() == ()


def test_a_fault_on_any_way_to_a_service_makes_it_look_at_the_samples_which_tell_the_tick():
    samples = Scene("plant/sample", "supervisor", Fault("partition", "controller>supervisor"))
    samples.conditions.see(0, NO_TRIAL)
    samples.put(5)
    assert samples.ticks() == [5]
    assert samples.conditions.tick == 5
    assert Scene("plant/sample", "supervisor", Fault("partition", "controller>plant")).inbox.detour is None
