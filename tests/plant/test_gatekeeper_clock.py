"""The gatekeeper between real time and lockstep: whose answers it has, how old a command is, and which commands are late."""

import pytest

from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL, GateCause, GateState, Mode, SampleDropped
from hydrohil.shared.transport import inbox
from hydrohil.shared.units import SUBSTEP_NS
from tests.plant.test_gatekeeper import MOVING, MS, Scene
from tests.support.wire_scene import ZERO, header

LATCH_NS = 72 * SUBSTEP_NS


class LockstepScene(Scene):
    """Samples whose time is their number times 4.5 ms, as in lockstep."""

    def echo(self):
        return {"echo_number": self.timeline.number, "echo_time_ns": self.now_ns}

    def sample(self, period_ns=4_500_000):
        self.now_ns += period_ns
        self.timeline.number += 1
        self.keeper.issue_sample(self.timeline.number, self.now_ns, self.now_ns, self.force_counts)

    def receive(self):
        self.keeper.receive_lockstep(self.now_ns + LATCH_NS, LATCH_NS, lambda *late: self.late.append(late))

    def drop_sample(self, key, number, **changes):
        self.seq += 1
        self.bus.send(key, header(key, self.seq, **changes), SampleDropped(number))


SERVICES = ["controller", "supervisor"]


def answered(scene):
    """Newest sample that each service has dealt with."""
    numbers = range(NO_COMMAND, 10)
    return {name: max(n for n in numbers if name not in scene.keeper.awaited(n)) for name in SERVICES}


def test_before_anything_came_no_service_has_answered_and_nothing_was_cut():
    scene = LockstepScene()
    keeper = scene.keeper
    assert answered(scene) == {"controller": NO_COMMAND, "supervisor": NO_COMMAND}
    assert (keeper.awaited(0), keeper._force_counts) == (SERVICES, 0)
    assert (keeper.stop_pressed, keeper.late_substeps, keeper.command_age_ns) == (False, 0, 0)
    status = keeper.status()
    assert (status["last_cut"], status["last_cut_ns"], status["last_cut_clock_ns"]) == ("NONE", 0, 0)
    assert (keeper.revoked, keeper.arming_id) == (frozenset(), 0)
    keeper.judge(0, at_latch=True)
    assert scene.bus.of("plant/gate") == []  # the force of 0 counts that stands before the first sample is valid


def test_a_command_that_missed_its_latch_is_reported_late_until_the_next_latch():
    scene = LockstepScene()
    scene.keeper.judge_late(0, 5)
    assert scene.keeper.late_substeps == 5
    scene.keeper.judge(0, at_latch=False)
    scene.keeper.stop(0)
    scene.keeper.release_stop(0)
    assert scene.keeper.late_substeps == 5
    scene.keeper.judge(0, at_latch=True)
    assert scene.keeper.late_substeps == 0


def test_in_lockstep_a_command_is_as_old_as_its_latch_and_its_sender_has_answered():
    scene = LockstepScene()
    scene.sample()
    scene.command(MOVING)
    scene.receive()
    assert answered(scene) == {"controller": 1, "supervisor": NO_COMMAND}
    scene.permit()
    scene.receive()
    assert answered(scene) == {"controller": 1, "supervisor": 1}
    assert (scene.late, scene.keeper.command_age_ns) == ([], LATCH_NS)
    scene.keeper.judge(scene.now_ns + LATCH_NS, at_latch=True)
    assert scene.device.codes == MOVING


@pytest.mark.parametrize(("delay_ns", "is_late"), [(LATCH_NS - 1, False), (LATCH_NS, False), (LATCH_NS + 1, True)])
def test_in_lockstep_only_a_command_that_a_fault_delays_past_its_latch_is_late(monkeypatch, delay_ns, is_late):
    scene = LockstepScene()
    monkeypatch.setattr(scene.keeper.commands, "delay_ns", lambda message: delay_ns)
    scene.sample()
    scene.command(MOVING)
    scene.receive()
    assert scene.keeper.command_age_ns == max(LATCH_NS, delay_ns)
    assert [substep for _, substep in scene.late] == [(scene.now_ns + delay_ns) // SUBSTEP_NS] * is_late


@pytest.mark.parametrize(
    ("key", "name"), [("controller/sample_dropped", "controller"), ("supervisor/sample_dropped", "supervisor")]
)
def test_a_sample_that_a_fault_took_is_awaited_no_more_and_a_report_of_another_run_changes_nothing(key, name):
    scene = LockstepScene()
    scene.sample()
    scene.drop_sample(key, 9, run=4)
    scene.receive()
    assert set(answered(scene).values()) == {NO_COMMAND}
    scene.drop_sample(key, 7)
    scene.receive()
    assert answered(scene) == {"controller": NO_COMMAND, "supervisor": NO_COMMAND} | {name: 7}
    scene.permit()
    scene.command()
    scene.receive()
    assert answered(scene) == {"controller": 1, "supervisor": 1} | {name: 7}


def test_an_answer_that_a_fault_holds_is_awaited_no_more(monkeypatch):
    scene = LockstepScene()
    monkeypatch.setattr(scene.keeper.commands, "arrived", lambda: 5)
    monkeypatch.setattr(scene.keeper.permits, "arrived", lambda: 6)
    assert answered(scene) == {"controller": 5, "supervisor": 6}


def test_in_real_time_a_command_is_as_old_as_its_sample_was_when_it_arrived(monkeypatch):
    scene = Scene()
    scene.sample()
    monkeypatch.setattr(inbox.time, "monotonic_ns", lambda: scene.now_ns + 2 * MS)
    scene.command(MOVING)
    scene.now_ns += 3 * MS
    scene.judge()
    assert scene.keeper.command_age_ns == 2 * MS
    assert [*scene.keeper._counters.command_age_ns] == [2 * MS]


@pytest.mark.parametrize(("number", "at_latch", "is_late"), [(0, True, False), (-1, True, True), (0, False, True)])
def test_in_real_time_a_command_is_late_that_answers_an_older_sample_or_comes_after_the_latch(number, at_latch, is_late):
    scene = Scene()
    scene.sample()
    scene.sample()
    scene.command(MOVING, echo_number=scene.timeline.number + number, echo_time_ns=scene.timeline.number + number)
    scene.keeper.receive(scene.now_ns, at_latch=at_latch, late=scene.late.append)
    assert [len(scene.late), len(scene.keeper._counters.command_age_ns)] == [is_late, not is_late]


def test_out_of_a_trial_the_age_of_a_command_counts_for_nothing():
    scene = Scene()
    scene.timeline.tick = NO_TRIAL
    scene.sample()
    scene.command()
    scene.judge()
    assert (scene.late, [*scene.keeper._counters.command_age_ns]) == ([], [])


def test_a_plant_that_has_overrun_shuts_the_gate_and_one_that_does_not_say_so_has_not():
    scene = Scene()
    assert scene.run(codes=MOVING).state == GateState.OPEN
    assert (scene.judge(overrun=True).cause, scene.device.codes) == (GateCause.OVERRUN, ZERO)


def test_a_new_trial_counts_its_late_sub_steps_anew_and_revokes_nothing_that_was_not_bound():
    scene = Scene()
    scene.keeper.judge_late(0, 5)
    scene.keeper.begin_trial()
    assert (scene.keeper.late_substeps, scene.keeper.revoked, len(scene.keeper.gate.revoked)) == (0, frozenset(), 16)
    assert set(scene.keeper.gate.revoked) == {0}


def test_an_arming_id_that_the_gate_is_given_again_after_a_trial_began_is_one_of_the_sixteen_that_it_holds():
    scene = Scene()
    for arming_id in range(1, 20):
        scene.run(arming_id)
        scene.permit(0, Mode.TRIPPED)
        scene.judge()
    scene.keeper.begin_trial()
    assert scene.run(1).cause == GateCause.REVOKED_ARMING
    assert scene.keeper.gate.revoked == (1, *range(19, 4, -1))
    assert scene.run(1).cause == GateCause.REVOKED_ARMING
    assert scene.keeper.gate.revoked == (1, *range(19, 4, -1))
    assert scene.keeper.revoked == frozenset(range(1, 20))
