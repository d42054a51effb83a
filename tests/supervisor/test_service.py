"""The supervisor's shell without a network: what it answers, and what it publishes."""

import json

import pytest

from hydrohil.services.supervisor import service
from hydrohil.services.supervisor.cell_view import Loaded
from hydrohil.services.supervisor.observe import observer_start
from hydrohil.services.supervisor.service import Supervisor
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.deadline_window import DeadlineWindow
from hydrohil.shared.contract.envelope import seal
from hydrohil.shared.contract.messages import NO_TRIAL, Mode, SampleDropped, TripCause
from hydrohil.shared.host.qualified import UNKNOWN, Qualified, Standing
from hydrohil.shared.transport.requests import Request
from tests.support.supervisor_scene import DESCRIPTION, sample
from tests.support.wire_scene import MACHINE_ID, FakeBus, header, state_body


class Scene:
    """A supervisor that has received from the plant, and a plant that is judged sample by sample."""

    def __init__(self, known=UNKNOWN):
        self.bus, self.known = FakeBus(), known
        self.supervisor = Supervisor(self.bus, lambda: self.known)
        self.describe(DESCRIPTION)
        self.number = 0
        self.judge()

    def describe(self, description):
        head = header("plant/description", run=self.bus.run.run, experiment=self.bus.run.experiment)
        self.supervisor.cell.describe(Received(0, "plant/description", head, description))

    def judge(self):
        run = self.bus.run
        self.describe(self.supervisor.cell.description)
        self.number += 1
        head = header("plant/sample", self.number, run=run.run, experiment=run.experiment)
        self.supervisor.cell.sample = Received(0, "plant/sample", head, sample(self.number))
        ready = type("Body", (), {"ready": 1, "machine_id": MACHINE_ID})()
        self.supervisor.cell.controller = Received(0, "controller/state", head, ready)
        self.supervisor._judge(self.supervisor.cell.sample, 0)

    def ask(self, verb, **arguments):
        answers = []
        self.supervisor.requests.answer(Request(verb, arguments, lambda *answer: answers.append(answer)))
        if not answers:
            self.judge()
        return answers[0]

    def load(self, clock="real", unqualified=False, **supervisor):
        text = seal({"supervisor": supervisor}, run=7, seed=1, clock=clock, tare_ticks=8, duration_ticks=100)
        return self.ask("load", envelope=text, unqualified=unqualified)

    def commit(self, values):
        return self.ask("commit", digest=values["digest"])

    def armed(self, **load):
        self.commit(self.load(**load)[2])
        return self.ask("arm")


def test_every_verdict_is_published_with_the_echo_of_the_sample_it_judged():
    scene = Scene()
    key, permit, echo = scene.bus.published[-1]
    assert (key, permit.mode, echo) == ("supervisor/permit", Mode.DISARMED, (1, 4_500_000))
    assert len(scene.bus.published) == 1


def test_arming_is_refused_in_words_without_an_experiment_and_granted_with_one():
    scene = Scene()
    accepted, reason, _ = scene.ask("arm")
    assert not accepted
    assert "no experiment is loaded" in reason
    assert scene.armed()[0]
    assert scene.bus.run.run == 7
    assert scene.bus.run.arming_id != 0


def test_every_arming_has_a_number_of_its_own():
    scene, numbers = Scene(), set()
    scene.commit(scene.load()[2])
    for _ in range(20):
        assert scene.ask("arm")[0]
        numbers.add(scene.bus.run.arming_id)
        scene.ask("stop")
        assert scene.bus.run.arming_id == 0
    assert len(numbers) == 20


def test_neither_load_nor_commit_is_taken_while_armed_or_running():
    scene = Scene()
    loaded = scene.load()[2]
    scene.commit(loaded)
    scene.ask("arm")
    arming_id = scene.bus.run.arming_id
    for _ in range(2):
        for accepted, reason, _ in (scene.load(), scene.commit(loaded)):
            assert not accepted
            assert "stop or reset first" in reason
        assert scene.bus.run.arming_id == arming_id
        scene.ask("start")
    assert scene.supervisor.memory.mode == Mode.RUNNING


def test_a_commit_without_its_load_is_refused():
    scene = Scene()
    assert not scene.ask("commit", digest="00")[0]
    scene.load()
    assert not scene.ask("commit", digest="00")[0]


def test_an_emergency_stop_does_not_wait_for_a_sample():
    scene = Scene()
    scene.armed()
    before = scene.number
    assert scene.ask("estop")[0]
    assert scene.number == before
    assert scene.bus.of("supervisor/permit")[-1].mode == Mode.TRIPPED
    assert scene.bus.run.arming_id == 0


@pytest.mark.parametrize(
    ("supervisor", "field"),
    [
        ({"force_limit_n": 335.0}, "force_limit_n"),
        ({"workspace_low_m": [-2.0, -2.0, -1.7]}, "workspace_low_m"),
        ({"workspace_high_m": [2.0, 2.1, 0.8]}, "workspace_high_m"),
        ({"joint_high_q": {"down_up": 0.48}}, "joint_high_q.down_up"),
        ({"bias_limit_n": 61.0}, "bias_limit_n"),
    ],
)
def test_an_experiment_may_tighten_a_limit_and_not_widen_it(supervisor, field):
    accepted, reason, _ = Scene().load(**supervisor)
    assert not accepted
    assert f"supervisor.{field}" in reason
    assert Scene().load(force_limit_n=100.0, workspace_low_m=[0.0, -1.0, -1.0])[0]


def test_a_request_that_is_unknown_is_refused_by_name():
    accepted, reason, _ = Scene().ask("dance")
    assert not accepted
    assert "'dance'" in reason
    assert json.dumps(Scene().supervisor.requests.status())


@pytest.mark.parametrize(("clock", "patient_ns"), [("real", 20_000_000), ("lockstep", 6_000_000_000)])
def test_a_request_to_a_cell_without_a_plant_is_answered_and_never_acts_later(monkeypatch, clock, patient_ns):
    scene, answers = Scene(), []
    text = seal({}, run=7, seed=1, clock=clock, tare_ticks=8, duration_ticks=100)
    scene.commit(scene.ask("load", envelope=text)[2])
    scene.supervisor.requests.answer(Request("arm", {}, lambda *answer: answers.append(answer)))
    monkeypatch.setattr(service.time, "monotonic_ns", lambda: patient_ns)
    scene.supervisor._judge_absence()
    assert not answers
    monkeypatch.setattr(service.time, "monotonic_ns", lambda: patient_ns + 1)
    scene.supervisor._judge_absence()
    assert [accepted for accepted, _, _ in answers] == [False]
    scene.judge()
    assert scene.supervisor.memory.mode == Mode.DISARMED


@pytest.mark.parametrize(
    ("age_ns", "patience_s"),
    [(0, 0.02), (15_000_000, 0.005), (19_999_999, 1e-9), (20_000_000, 0.0), (20_000_001, 0.1)],
)
def test_absence_is_judged_a_lease_after_the_last_sample_whoever_judged_that_one(monkeypatch, age_ns, patience_s):
    scene = Scene()
    scene.armed()
    arrival_ns = scene.supervisor.cell.sample.arrival_ns
    monkeypatch.setattr(service.time, "monotonic_ns", lambda: arrival_ns + age_ns)
    assert scene.supervisor._patience_s() == pytest.approx(patience_s, rel=1e-6)


def test_without_a_plant_there_is_no_absence_to_wait_for():
    assert Supervisor(Scene().bus)._patience_s() == 0.1


def test_the_link_statistics_are_published_once_a_second_and_at_a_trip():
    scene = Scene()
    scene.armed()
    for _ in range(300):
        scene.judge()
    assert [stats.number for stats in scene.bus.of("supervisor/link_stats")] == [222]
    scene.ask("estop")
    stats = scene.bus.of("supervisor/link_stats")[-1]
    assert stats.number == scene.number
    assert [inbox.topic for inbox in stats.inboxes] == ["plant/sample", "controller/state", "plant/description"]


class Linked(Scene):
    """The same, with frames in its inboxes instead of messages put in place."""

    def step(self, *, samples=1, sample_epoch=31, state_epoch=22, state_run=None):
        run = self.bus.run
        for _ in range(samples):
            self.number += 1
            ours = {"run": run.run, "experiment": run.experiment}
            head = header("plant/sample", self.number, epoch=sample_epoch, **ours)
            state = header("controller/state", self.number, epoch=state_epoch, **(ours | (state_run or {})))
            self.bus.send("controller/state", state, state_body(self.number))
            self.bus.send("plant/sample", head, sample(self.number))
        self.supervisor.step()
        return self.supervisor.memory

    def sampled_alone(self):
        """A sample of a trial without the controller's state before it; how many verdicts it gets."""
        before = len(self.bus.of("supervisor/permit"))
        run, number = self.bus.run, self.number + 2
        self.bus.send("plant/sample", header("plant/sample", number, run=run.run, experiment=run.experiment), sample(number, 3))
        self.supervisor.step()
        return len(self.bus.of("supervisor/permit")) - before

    def started(self):
        self.step()
        self.commit(self.load()[2])
        self.describe(self.supervisor.cell.description)
        self.step()
        for verb in ("arm", "start"):
            self.supervisor.requests.answer(Request(verb, {}, lambda *answer: None))
            self.step()
        assert self.supervisor.memory.mode == Mode.RUNNING
        return self

    def again(self, key):
        """The last frame once more."""
        ours = {"run": self.bus.run.run, "experiment": self.bus.run.experiment}
        body = sample(self.number) if key == "plant/sample" else state_body(self.number)
        self.bus.send(key, header(key, self.number, **ours), body)


@pytest.mark.parametrize("key", ["plant/sample", "controller/state"])
def test_one_frame_that_comes_again_is_survived_and_a_second_one_within_a_second_trips(key):
    scene = Linked().started()
    scene.again(key)
    assert scene.step().mode == Mode.RUNNING
    scene.again(key)
    memory = scene.step()
    assert (memory.mode, memory.cause, memory.measured, memory.limit) == (Mode.TRIPPED, TripCause.LINK_FAULTS, 2.0, 1.0)


@pytest.mark.parametrize("epoch", [{"sample_epoch": 99}, {"state_epoch": 99}])
def test_two_publishers_on_a_topic_trip_a_trial_and_refuse_arming(epoch):
    scene = Linked().started()
    scene.step(**epoch)
    scene.step()
    memory = scene.step(**epoch)
    assert (memory.mode, memory.cause) == (Mode.TRIPPED, TripCause.TWO_PUBLISHERS)
    assert not scene.ask("reset")[0]
    assert scene.supervisor.memory.mode == Mode.TRIPPED


@pytest.mark.parametrize("changes", [{"run": 8}, {"experiment": b"another"}])
def test_a_controller_of_another_run_or_experiment_trips_even_before_anything_moves(changes):
    scene = Linked().started()
    assert scene.step(state_run=changes).cause == TripCause.OTHER_RUN
    assert scene.supervisor.cell.states.acceptance.other_run == 1


def test_a_single_state_of_another_run_between_two_samples_is_not_overlooked():
    scene = Linked().started()
    for run in (8, scene.bus.run.run):
        scene.number += 1
        head = header("controller/state", scene.number, run=run, experiment=scene.bus.run.experiment)
        scene.bus.send("controller/state", head, state_body(scene.number))
    assert scene.step().cause == TripCause.OTHER_RUN


def test_in_lockstep_a_second_is_a_second_of_samples():
    scene = Linked()
    scene.step()
    text = seal({}, run=7, seed=1, clock="lockstep", tare_ticks=8, duration_ticks=100)
    scene.commit(scene.ask("load", envelope=text)[2])
    scene.again("plant/sample")
    scene.step()
    scene.step(samples=221)
    scene.again("plant/sample")
    scene.step()
    assert scene.supervisor.cell.samples.protection.observe(scene.number * 4_500_000).faults == 2
    scene.step(samples=2)
    assert scene.supervisor.cell.samples.protection.observe(scene.number * 4_500_000).faults == 1


def test_answers_that_are_not_in_time_are_in_the_status():
    scene = Scene()
    scene.supervisor.memory = scene.supervisor.memory._replace(
        observer=observer_start()._replace(answers=DeadlineWindow(0b11110, 0, 4, 3))
    )
    assert (scene.supervisor.requests.status()["in_time"], scene.supervisor.requests.status()["warnings"]) == (0.96, [])
    scene.supervisor.memory = scene.supervisor.memory._replace(
        observer=observer_start()._replace(answers=DeadlineWindow(0b1111, 0, 4, 4))
    )
    assert scene.supervisor.requests.status()["warnings"] == ["4 answers in a row were late or missing; the lease bears 4"]


def test_a_lockstep_commit_after_an_injection_is_refused_and_nothing_has_changed():
    scene = Scene()
    values = scene.ask("load", envelope=seal({}, run=7, seed=1, clock="lockstep", tare_ticks=8, duration_ticks=100))[2]
    loss = {"kind": "loss", "target": "plant>supervisor", "value": 0.5}
    assert scene.ask("inject", fault=loss)[0]
    accepted, reason, _ = scene.commit(values)
    assert not accepted and "--clear" in reason
    assert scene.supervisor.cell.envelope is None and scene.bus.run.run == 0
    scene.ask("clear")
    assert scene.commit(values)[0]


@pytest.mark.parametrize(("behind", "mode"), [(1, Mode.RUNNING), (2, Mode.RUNNING), (5, Mode.RUNNING), (6, Mode.TRIPPED)])
def test_a_supervisor_that_falls_behind_by_a_lease_does_not_take_the_controller_for_silent(behind, mode):
    scene = Linked().started()
    first = scene.supervisor.memory.first_sample
    ours = {"run": scene.bus.run.run, "experiment": scene.bus.run.experiment}

    def send(number):
        state = header("controller/state", number, echo_number=number, **ours)
        scene.bus.send("controller/state", state, state_body(number))
        observed = sample(number, number - first - 8, command_number=number - 1)
        scene.bus.send("plant/sample", header("plant/sample", number, **ours), observed)

    for number in range(first, first + 12):
        send(number)
        scene.supervisor.step()
    for number in range(first + 12, first + 12 + behind):
        send(number)
    scene.supervisor.step()
    assert Mode(scene.supervisor.memory.mode) == mode


class InStep(Linked):
    """A lockstep trial of eight tare ticks that begins with sample 1."""

    def __init__(self):
        super().__init__()
        text = seal({}, run=7, seed=1, clock="lockstep", tare_ticks=8, duration_ticks=100)
        self.commit(self.ask("load", envelope=text)[2])
        self.ours = {"run": self.bus.run.run, "experiment": self.bus.run.experiment}
        self.judged()

    def sampled(self, number, tick):
        head = header("plant/sample", number, echo_number=number, **self.ours)
        self.bus.send("plant/sample", head, sample(number, tick))
        return self

    def answered(self, number):
        head = header("controller/state", number, echo_number=number, **self.ours)
        self.bus.send("controller/state", head, state_body(number))
        return self

    def passed(self, number, seq, **changes):
        head = header("controller/sample_dropped", seq, **(self.ours | changes))
        self.bus.send("controller/sample_dropped", head, SampleDropped(number))
        return self

    def judged(self):
        """Samples judged since the last call."""
        before = len(self.bus.published)
        self.supervisor.step()
        return [echo[0] for key, _, echo in self.bus.published[before:] if key == "supervisor/permit"]


def test_in_lockstep_a_sample_waits_for_the_controllers_state_before_it():
    scene = InStep()
    assert scene.sampled(10, -8).judged() == [10]  # the trial's first: before it nobody waited
    assert scene.sampled(11, -7).judged() == []
    assert scene.judged() == []
    assert scene.answered(9).judged() == []
    assert scene.answered(10).judged() == [11]
    assert scene.answered(11).sampled(12, -6).judged() == [12]


def test_in_lockstep_nobody_waits_for_the_answer_to_a_sample_that_a_fault_kept_from_the_controller():
    scene = InStep()
    assert scene.sampled(10, -8).judged() == [10]
    assert scene.sampled(11, -7).passed(10, 0, run=8).judged() == []
    assert scene.passed(10, 1).judged() == [11]


def test_outside_a_lockstep_trial_no_sample_waits():
    scene = InStep()
    assert scene.sampled(11, NO_TRIAL).judged() == [11]
    assert Linked().started().sampled_alone() == 1


def test_a_new_load_forgets_the_samples_that_wait():
    scene = InStep()
    scene.sampled(10, -8).judged()
    assert scene.sampled(11, -7).judged() == []
    scene.supervisor.requests._loading._pending = (
        scene.supervisor.cell.envelope,
        Loaded(scene.supervisor.cell.config, unqualified=False),
    )
    scene.commit({"digest": scene.supervisor.cell.envelope.digest.hex()})
    assert scene.answered(10).judged() == []


def qualified_for(period_ns):
    """A host on which this period is the shortest that is qualified."""
    return Standing(
        Qualified(
            qualified_period_ns=period_ns,
            grade="B",
            measured_at="yesterday",
            period_ns=period_ns or 1,
            samples=4000,
            late_share=0.0,
            accepted_p999_us=1.0,
            wake_up_max_us=1.0,
            lease_ms=20.0,
        ),
        "qualified",
    )


@pytest.mark.parametrize(
    ("period_ns", "armed"),
    [
        (DESCRIPTION.sample_period_ns, True),
        (DESCRIPTION.sample_period_ns - 50_000, True),
        (DESCRIPTION.sample_period_ns + 50_000, False),
        (0, False),
    ],
)
def test_a_rate_that_is_signed_is_armed_and_one_just_above_it_is_refused_with_both(period_ns, armed):
    scene = Scene(qualified_for(period_ns))
    accepted, reason, _ = scene.armed()
    assert accepted == armed
    assert scene.bus.run.arming_id != 0 if armed else scene.bus.run.arming_id == 0
    assert armed or all(word in reason for word in ("222.2 Hz", "hydrohil qualify", "--unqualified"))


def test_above_the_signed_rate_it_arms_only_for_the_run_that_is_loaded_so_on_purpose():
    scene = Scene(qualified_for(0))
    assert scene.armed(unqualified=True)[0]
    scene.ask("stop")
    assert not scene.armed()[0]
    for word in ("true", 1, None):
        assert not scene.armed(unqualified=word)[0]


def test_in_lockstep_the_host_does_not_matter():
    assert Scene(qualified_for(0)).armed(clock="lockstep")[0]


def test_a_host_without_a_record_arms_and_says_that_it_is_not_qualified():
    scene = Scene()
    assert scene.supervisor.requests.status()["qualification"] is None
    assert "hydrohil qualify" in scene.supervisor.requests.status()["qualified"]
    assert scene.armed()[0]


def test_a_record_written_since_the_start_counts_from_the_next_load_on():
    scene = Scene()
    assert scene.armed()[0]
    scene.known = qualified_for(0)
    assert scene.ask("start")[0]
    assert scene.supervisor.requests.status()["qualification"] is None
    scene.ask("stop")
    assert scene.load()[2]["qualification"] == scene.known.qualified._asdict()
    assert not scene.armed()[0]


def test_an_armed_cell_whose_plant_then_describes_a_faster_rate_is_disarmed():
    scene = Scene(qualified_for(DESCRIPTION.sample_period_ns))
    assert scene.armed()[0]
    scene.describe(DESCRIPTION._replace(sample_period_ns=DESCRIPTION.sample_period_ns - 50_000))
    scene.judge()
    assert scene.supervisor.memory.mode == Mode.DISARMED
