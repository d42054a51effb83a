"""The plant's shell on a wall clock that a test turns: when an emergency stop takes effect, and which sample reports it."""

import pytest

from hydrohil.services.plant import plant_clock, service
from hydrohil.services.plant import warmup as warmups
from hydrohil.services.plant.config import GateLimits, PlantConfig
from hydrohil.services.plant.device import Reading, Timeline
from hydrohil.services.plant.trial import Schedule
from hydrohil.shared.contract.envelope import seal, unseal
from hydrohil.shared.contract.messages import GateCause, GateState
from hydrohil.shared.host import clock
from hydrohil.shared.host.lease import LeaseChoice
from hydrohil.shared.transport import inbox
from hydrohil.shared.units import SUBSTEP_NS
from tests.support.wire_scene import ZERO, FakeBus, Query, command_body, header, permit_body

MOVING = (2100, 2000, 2048)
PERIOD, LATCH = 90, 72  # sub-steps of the thesis' period and of its latch
LEASE_NS = GateLimits().permit_ttl_ns
FIRST = 3  # sample of the trial's first tick
CONFIG = PlantConfig(bias_s=0.11)
OPENED = FIRST + 24 + 1  # tare ticks before tick 0, and one sample until the opened gate is reported


class Wall:
    """Time that passes only while somebody sleeps; what is due meanwhile happens at its instant."""

    def __init__(self):
        self.now_ns, self.coming = 0, []

    def monotonic_ns(self):
        return self.now_ns

    def monotonic(self):
        return self.now_ns * 1e-9

    def sleep(self, seconds):
        until_ns = self.now_ns + round(seconds * 1e9)
        while due := sorted((entry for entry in self.coming if entry[0] <= until_ns), key=lambda entry: entry[0]):
            self.coming.remove(due[0])
            self.now_ns = max(self.now_ns, due[0][0])
            due[0][1]()
        self.now_ns = max(self.now_ns, until_ns)

    def at(self, instant_ns, happens):
        self.coming.append((instant_ns, happens))


class Device:
    """Keeps every change of the codes with its sub-step."""

    def __init__(self, timeline):
        self.timeline, self.written = timeline, [(0, ZERO)]

    def begin(self):
        pass

    def read(self):
        return Reading((4031, 971, 206, 0, 33), 10)

    def write(self, codes):
        if codes != self.written[-1][1]:
            self.written.append((self.timeline.substep, codes))

    def readback(self):
        return None

    def ground_truth(self):
        return None

    def faults(self):
        return (), ()


class Peers(FakeBus):
    """Supervisor and controller answer each sample after 0.4 ms and let the machine move."""

    def __init__(self, wall):
        super().__init__("plant")
        self.wall = wall

    def publish(self, key, body, echo=(-1, 0)):
        super().publish(key, body, echo)
        if key == "plant/sample":
            self.wall.at(self.wall.now_ns + 400_000, lambda: self.answer(body))

    def answer(self, sample):
        echo = {"echo_number": sample.number, "echo_time_ns": sample.time_ns}
        self.send("supervisor/permit", header("supervisor/permit", sample.number, **echo), permit_body(first_sample=FIRST))
        self.send("controller/command", header("controller/command", sample.number, **echo), command_body(MOVING))


class Scene:
    """A plant whose gate is open, or that waits for its trial."""

    def __init__(self, monkeypatch, clock_name="real", opened=True):
        self.wall, timeline = Wall(), Timeline()
        for module in (plant_clock, service, warmups, clock, inbox):
            monkeypatch.setattr(module, "time", self.wall)
        self.bus, self.device = Peers(self.wall), Device(timeline)
        self.plant = service.Plant(self.bus, self.device, timeline, GateLimits(), lambda: False, LeaseChoice(fixed=True))
        text = seal({}, run=0, seed=0, clock=clock_name, tare_ticks=24, duration_ticks=400)
        self.plant.clock.schedule = Schedule(CONFIG, unseal(text))
        while timeline.number < (OPENED if opened else FIRST - 1):
            self.period()
        assert (self.plant.keeper.gate.state == GateState.OPEN and self.device.written[-1][1] == MOVING) == opened

    def period(self):
        self.plant.sample()
        self.plant.update_outputs()
        self.plant.serve()

    def asks(self, substep, verb="estop"):
        """A request that arrives at a sub-step of this period's time."""
        query = Query("plant", verb)
        self.wall.at(self.plant.clock.grid.instant_ns(substep), lambda: self.bus.asked.put(query))
        return query

    def reported(self):
        """Number of the first sample that reports the stop, and its codes."""
        return next((s.number, s.dac_counts) for s in self.bus.of("plant/sample") if s.gate_cause == GateCause.ESTOP)


@pytest.mark.parametrize("phase", range(PERIOD))
def test_an_emergency_stop_takes_effect_at_the_next_sample_or_latch_and_the_sample_then_or_next_reports_it(monkeypatch, phase):
    scene = Scene(monkeypatch)
    number, due = scene.plant.timeline.number, scene.plant.clock.due
    scene.asks(due + phase)
    scene.period()
    scene.period()
    stopped = due if phase == 0 else due + LATCH if phase <= LATCH else due + PERIOD
    assert scene.device.written[-1] == (stopped, ZERO)
    assert scene.reported() == (number if phase == 0 else number + 1, ZERO)


def test_an_emergency_stop_waits_for_no_longer_than_the_longer_part_of_the_period(monkeypatch):
    waits = []
    for phase in range(PERIOD):
        scene = Scene(monkeypatch)
        pressed = scene.plant.clock.due + phase
        scene.asks(pressed)
        scene.period()
        scene.period()
        waits.append(scene.device.written[-1][0] - pressed)
    assert max(waits) == max(LATCH, PERIOD - LATCH) - 1  # pressed a sub-step after the sample


def test_the_stop_is_answered_with_the_codes_at_the_converter_and_stays(monkeypatch):
    scene = Scene(monkeypatch)
    query = scene.asks(scene.plant.clock.due + 1)
    scene.period()
    assert len(query.replies) == 1 and b'"dac_counts": [2048, 2048, 2048]' in query.replies[0]
    for _ in range(5):
        scene.period()
    assert scene.device.written[-1][1] == ZERO and scene.plant.keeper.gate.state == GateState.REVOKED


def test_what_is_no_emergency_stop_keeps_the_way_of_sample_and_command_free(monkeypatch):
    scene = Scene(monkeypatch)
    reset = scene.asks(scene.plant.clock.due - 1, "reset")
    scene.plant.sample()
    scene.plant.update_outputs()
    assert not reset.replies
    scene.plant.serve()
    assert len(reset.replies) == 1


def test_a_request_that_only_speaks_of_a_stop_keeps_its_turn(monkeypatch):
    scene = Scene(monkeypatch)
    query = Query("plant", "load", envelope="\u05e5estop")
    scene.bus.asked.put(query)
    scene.plant.sample()
    scene.plant.update_outputs()
    assert scene.plant.keeper.gate.state == GateState.OPEN
    scene.plant.serve()
    assert len(query.replies) == 1


def test_in_lockstep_a_stop_is_served_while_the_plant_waits_for_an_answer(monkeypatch):
    scene = Scene(monkeypatch)
    scene.plant.clock.schedule.envelope = scene.plant.clock.schedule.envelope._replace(clock="lockstep")
    scene.bus.answer = lambda sample: None  # nobody answers any more
    query = Query("plant", "estop")
    coming = [query]
    scene.bus.wait = lambda timeout_s: coming and scene.bus.asked.put(coming.pop())
    scene.plant.sample()
    due = scene.plant.clock.due
    scene.plant.update_outputs()
    assert len(query.replies) == 1
    assert scene.device.written[-1][1] == ZERO and scene.device.written[-1][0] <= due + LATCH


def test_in_a_trial_on_the_wall_clock_the_last_sample_goes_out_twice_more_after_the_latch(monkeypatch):
    scene = Scene(monkeypatch)
    scene.period()
    sent = len(scene.bus.of("plant/warmup"))
    scene.plant.sample()
    last, repeated = scene.bus.of("plant/sample")[-2], scene.bus.of("plant/warmup")[sent:]
    assert repeated == [last, last]
    assert scene.plant.status()["warmups"] == sent + 2


def test_before_a_trial_no_warmup_frame_is_sent(monkeypatch):
    assert not Scene(monkeypatch, opened=False).bus.of("plant/warmup")


def test_in_lockstep_no_warmup_frame_is_sent(monkeypatch):
    scene = Scene(monkeypatch)
    scene.plant.clock.schedule.envelope = scene.plant.clock.schedule.envelope._replace(clock="lockstep")
    sent = len(scene.bus.of("plant/warmup"))
    scene.plant.sample()
    assert len(scene.bus.of("plant/warmup")) == sent


def test_answers_in_lockstep_which_come_at_the_latch_pause_no_warmup_frames(monkeypatch):
    scene = Scene(monkeypatch)
    real = scene.plant.clock.schedule.envelope
    scene.plant.clock.schedule.envelope = real._replace(clock="lockstep")
    scene.plant.keeper._command_age_ns = LATCH * SUBSTEP_NS
    for _ in range(2):
        scene.plant._count()
    scene.plant.clock.schedule.envelope = real
    sent = len(scene.bus.of("plant/warmup"))
    scene.plant.sample()
    assert len(scene.bus.of("plant/warmup")) == sent + 2


def test_no_warmup_frame_is_sent_while_samples_are_not_answered(monkeypatch):
    scene = Scene(monkeypatch)
    scene.bus.answer = lambda sample: None
    scene.period()
    scene.period()
    sent = len(scene.bus.of("plant/warmup"))
    scene.period()
    assert sent > 0 and len(scene.bus.of("plant/warmup")) == sent


@pytest.mark.parametrize(
    ("clock_name", "stalled_ns", "revoked"),
    [("real", LEASE_NS, set()), ("real", LEASE_NS + 1, {77}), ("lockstep", LEASE_NS + 1, set())],
)
def test_a_stall_before_the_first_tick_revokes_the_arming_only_where_the_wall_clock_paces(
    monkeypatch, clock_name, stalled_ns, revoked
):
    scene = Scene(monkeypatch, clock_name, opened=False)
    due_ns = scene.plant.clock.grid.instant_ns(scene.plant.clock.due)
    scene.wall.at(due_ns, lambda: setattr(scene.wall, "now_ns", due_ns + stalled_ns))
    scene.plant.sample()
    assert scene.plant.keeper.revoked == revoked


def test_a_stall_while_recovering_revokes_the_arming_in_a_lockstep_cell_too(monkeypatch):
    scene = Scene(monkeypatch, "lockstep", opened=False)
    scene.plant.keeper._gate = scene.plant.keeper.gate._replace(state=int(GateState.RECOVERING), arming_id=77)
    due_ns = scene.plant.clock.grid.instant_ns(scene.plant.clock.due)
    scene.wall.at(due_ns, lambda: setattr(scene.wall, "now_ns", due_ns + LEASE_NS + 1))
    scene.plant.sample()
    assert scene.plant.keeper.revoked == {77}
