from types import SimpleNamespace

import pytest

from hydrohil.shared.contract.codec import encode
from hydrohil.shared.contract.envelope import seal, unseal
from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.contract.messages import NO_TRIAL
from hydrohil.shared.contract.topics import BY_KEY, expression
from hydrohil.shared.transport.impairment_conditions import Conditions, conditions_of, idle
from hydrohil.shared.transport.impairment_queue import FOREVER_NS
from hydrohil.shared.transport.inbox import RING, Inbox
from hydrohil.shared.units import SUBSTEP_NS
from tests.support.supervisor_scene import sample
from tests.support.wire_scene import CELL, command_body, header, permit_body, state_body

PERIOD = 90
ZERO_NUMBER = 100  # sample of tick 0
LATE = Fault("delay", "controller>plant", value=9.0)


class Scene:
    """One inbox under faults, fed by hand."""

    def __init__(self, key, receiver, *faults, lockstep=True):
        self.key = key
        self.inbox = Inbox(BY_KEY[key], CELL, RING, lambda: None)
        self.conditions = Conditions(receiver, faults, seed=3, period=PERIOD, ticks=(-8, 400), lockstep=lockstep)
        self.conditions.observe_sample(ZERO_NUMBER, 0)
        self.inbox.impair(self.conditions)

    def issue(self, tick):
        """The plant has issued this sample; outside a trial it has no tick."""
        conditions = self.conditions
        conditions.observe_sample(ZERO_NUMBER + tick, NO_TRIAL if conditions.tick == NO_TRIAL else tick)

    def put(self, tick, *, seq=None, body=None, echo_tick=None):
        if self.conditions.service == "plant" and ZERO_NUMBER + tick > self.conditions.number:
            self.issue(tick)
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
    assert scene.inbox.impairment_queue is None


def test_a_late_command_comes_at_its_sub_step_of_simulated_time_and_no_step_waits_for_it():
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


@pytest.mark.parametrize("forged", [1, 1000, 1 << 40])
@pytest.mark.parametrize("lockstep", [True, False])
def test_an_answer_to_a_sample_that_was_never_issued_delays_no_step_and_hides_no_other_answer(forged, lockstep):
    scene = Scene("controller/command", "plant", LATE, lockstep=lockstep)
    scene.put(4)
    scene.put(5, seq=900, echo_tick=5 + forged)
    assert scene.inbox.drain(instant(5)) == []
    assert scene.inbox.arrived() == ZERO_NUMBER + 4
    scene.put(5, seq=901)
    assert scene.inbox.drain(instant(5)) == []
    assert scene.inbox.arrived() == ZERO_NUMBER + 5
    if lockstep:
        came = [message.header.echo_number - ZERO_NUMBER for message in scene.inbox.drain(instant(5, 180))]
        assert sorted(came) == [4, 5, 5 + forged]


def test_an_echo_of_a_time_that_has_not_come_delays_no_step():
    scene = Scene("controller/command", "plant", LATE)
    scene.issue(5)
    head = header("controller/command", 1, echo_number=ZERO_NUMBER + 5, echo_time_ns=1 << 60)
    frame = encode(expression(CELL, "controller/command"), head, command_body())
    scene.inbox.put(SimpleNamespace(payload=SimpleNamespace(to_bytes=lambda: frame)))
    assert scene.ticks(instant(5)) == []
    assert scene.inbox.arrived() != ZERO_NUMBER + 5
    scene.put(5)
    assert scene.ticks(instant(5, 180)) == [5, 5]


def test_who_hears_the_controller_before_the_plant_believes_as_many_samples_as_a_ring_holds():
    for ahead, believed in ((64, True), (65, False)):
        scene = Scene("controller/state", "supervisor", Fault("loss", "controller>supervisor", value=1e-9))
        scene.put(ahead, body=state_body())
        scene.ticks()
        assert (scene.inbox.arrived() == ZERO_NUMBER + ahead) == believed


def test_a_sample_whose_echo_is_not_its_own_number_moves_no_fault():
    scene = Scene("plant/sample", "supervisor", Fault("burst", "plant>supervisor", value=1.0))
    scene.put(0, body=sample(ZERO_NUMBER + 300)._replace(tick=300))
    assert (scene.conditions.number, scene.conditions.tick, scene.inbox.arrived()) == (ZERO_NUMBER, 0, -1)


def test_outside_a_trial_nothing_happens_to_a_frame():
    scene = Scene("controller/command", "plant", Fault("partition", "controller>plant"))
    scene.conditions.observe_sample(ZERO_NUMBER, NO_TRIAL)
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


def test_a_flipped_bit_is_found_by_the_checksum():
    scene = Scene("controller/command", "plant", Fault("corrupt", "controller>plant", lasts_s=0.045, value=1.0))
    for tick in range(10):
        scene.put(tick)
    assert scene.ticks() == []
    assert scene.inbox.acceptance.discarded["crc"] == 10


def test_a_cut_takes_what_is_sent_again_on_an_old_sample_too():
    scene = Scene("supervisor/permit", "plant", Fault("partition", "supervisor>plant", 0.045))
    scene.put(9, body=permit_body())
    assert scene.ticks() == [9]
    scene.conditions.observe_sample(ZERO_NUMBER + 12, 12)
    scene.put(12, echo_tick=9, seq=999, body=permit_body())
    assert scene.ticks() == []


def test_a_cut_takes_every_topic_of_its_path():
    scene = Scene("plant/description", "supervisor", Fault("partition", "plant>supervisor"))
    assert scene.inbox.impairment_queue is not None
    passed = Inbox(BY_KEY["controller/sample_dropped"], CELL, RING, lambda: None)
    passed.impair(Conditions("plant", (Fault("partition", "controller>plant"),), seed=1, period=90, ticks=(0, 9), lockstep=True))
    assert passed.impairment_queue is None  # word of what a fault took is no message of the rig


def test_in_lockstep_a_lost_sample_is_reported_and_a_late_one_answered_at_once():
    lost = Scene("plant/sample", "controller", Fault("burst", "plant>controller", value=1.0))
    lost.put(-1)
    lost.put(0)
    assert lost.ticks() == [-1]
    assert [(p.number, p.taken) for p in lost.inbox.impaired_samples()] == [(ZERO_NUMBER, False)]
    late = Scene("plant/sample", "controller", Fault("delay", "plant>controller", value=50.0))
    late.put(0)
    assert late.ticks() == [0]


def test_silence_is_simulated_time_since_the_newest_sample_that_had_come():
    scene = Scene("plant/sample", "supervisor", Fault("partition", "plant>supervisor"))
    for tick in (-2, -1, 0, 1):
        scene.put(tick)
    scene.ticks()
    assert [impaired.silence_ns for impaired in scene.inbox.impaired_samples()] == [4_500_000, 9_000_000]


def test_in_real_a_late_frame_waits_on_the_wall_clock_and_the_wake_up_is_known():
    scene = Scene("controller/command", "plant", LATE, lockstep=False)
    scene.put(5)
    assert scene.ticks() == []
    impairment_queue = scene.inbox.impairment_queue
    assert impairment_queue.released(0, impairment_queue.next_ns() - 1) == []
    (frame,) = impairment_queue.released(0, impairment_queue.next_ns())
    assert frame.arrival_ns > 0


def load(faults, clock="lockstep"):
    text = seal({"faults": faults}, run=1, seed=1, clock=clock, tare_ticks=8, duration_ticks=100)
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


def test_delays_that_add_up_to_more_than_a_second_on_one_path_are_refused():
    late = {"kind": "delay", "target": "controller>plant", "value": 600.0, "lasts_s": 0.1}
    more = {"kind": "jitter", "target": "controller>plant", "value": 400.0, "at_s": 0.05}
    assert load([late, more]).service == "plant"
    assert load([late, more | {"value": 401.0, "at_s": 0.1}]).service == "plant"  # one after the other
    assert load([late, late | {"target": "supervisor>plant"}]).service == "plant"
    for worse in (more | {"value": 401.0}, more | {"value": 401.0, "at_s": -0.01}):
        with pytest.raises(ValueError, match=r"controller>plant add up to 1001 ms at .*, expected at most 1000 ms"):
            load([late, worse])


def test_lockstep_is_refused_while_something_injected_acts():
    before = idle("plant")
    before.inject(((Fault("loss", "controller>plant", value=0.1), 7),))
    with pytest.raises(ValueError, match="inject --clear"):
        conditions_of(unseal(seal({}, run=1, seed=1, clock="lockstep", tare_ticks=8, duration_ticks=100)), before)
    kept = conditions_of(unseal(seal({}, run=1, seed=1, clock="real", tare_ticks=8, duration_ticks=100)), before)
    assert kept.by_hand == before.by_hand


def test_what_is_injected_by_hand_begins_with_the_next_sample_in_a_trial_or_outside():
    scene = Scene("controller/command", "plant", lockstep=False)
    assert scene.inbox.impairment_queue is None
    scene.conditions.observe_sample(ZERO_NUMBER + 4, NO_TRIAL)
    scene.conditions.inject(((Fault("burst", "controller>plant", value=2.0), ZERO_NUMBER + 4),))
    scene.inbox.impair(scene.conditions)
    assert len(scene.conditions.lasting()) == 1
    for tick in range(4, 9):
        scene.put(tick)
    assert scene.ticks() == [4, 7, 8]
    assert scene.conditions.lasting() == ()


def test_a_fault_on_any_path_to_a_service_acts_on_its_samples_too_which_carry_the_tick():
    samples = Scene("plant/sample", "supervisor", Fault("partition", "controller>supervisor"))
    samples.conditions.observe_sample(0, NO_TRIAL)
    samples.put(5)
    assert samples.ticks() == [5]
    assert samples.conditions.tick == 5
    assert Scene("plant/sample", "supervisor", Fault("partition", "controller>plant")).inbox.impairment_queue is None
