import pytest
from gate_scene import FINE
from wire_scene import ZERO, FakeBus, command_body, header, permit_body

from services.plant.config import GateLimits
from services.plant.counters import Counters
from services.plant.device import Timeline
from services.plant.gatekeeper import Gatekeeper, numbers
from shared.converters import N_PER_FORCE_COUNT
from shared.messages import GateCause, GateState, Mode

MS = 1_000_000
MOVING = (2100, 2000, 2048)


class FakeDevice:
    def __init__(self):
        self.codes = ZERO

    def write(self, codes):
        self.codes = codes


class Scene:
    """A gatekeeper whose plant issues a sample every 4.5 ms; permits and commands answer it."""

    def __init__(self):
        self.bus, self.device, self.timeline = FakeBus(), FakeDevice(), Timeline()
        self.keeper = Gatekeeper(self.bus, self.device, self.timeline, GateLimits(), Counters())
        self.timeline.tick = 0
        self.now_ns = self.seq = 0
        self.late = []

    def sample(self, period_ns=4_500_000):
        self.now_ns += period_ns
        self.timeline.number += 1
        self.keeper.ledger.issue(self.timeline.number, self.timeline.number, self.now_ns)

    def echo(self):
        return {"echo_number": self.timeline.number, "echo_time_ns": self.timeline.number}

    def permit(self, arming=77, mode=Mode.RUNNING, **changes):
        self.seq += 1
        self.bus.send(
            "supervisor/permit",
            header("supervisor/permit", self.seq, arming=arming, **(self.echo() | changes)),
            permit_body(mode),
        )

    def command(self, codes=ZERO, arming=77, **changes):
        self.seq += 1
        self.bus.send(
            "controller/command",
            header("controller/command", self.seq, arming=arming, **(self.echo() | changes)),
            command_body(codes),
        )

    def judge(self, **changes):
        self.keeper.receive(self.now_ns, at_latch=True, late=self.late.append)
        self.keeper.judge(self.now_ns, **({"at_latch": True} | changes))
        return self.keeper.gate

    def run(self, arming=77, codes=ZERO):
        self.sample()
        self.permit(arming)
        self.command(codes, arming)
        return self.judge()


def test_without_messages_the_device_gets_zero_current():
    scene = Scene()
    scene.device.codes = MOVING
    scene.judge()
    assert scene.device.codes == ZERO


def test_a_permit_and_a_command_move_the_device_until_their_lease_ends():
    scene = Scene()
    assert scene.run(codes=MOVING).state == GateState.OPEN
    assert scene.device.codes == MOVING
    scene.now_ns += 20 * MS
    assert scene.judge().state == GateState.OPEN
    scene.now_ns += 1
    assert scene.judge().cause == GateCause.PERMIT_STALE
    assert scene.device.codes == ZERO


def test_a_fresh_frame_does_not_refresh_an_old_judgement():
    scene = Scene()
    scene.run(codes=MOVING)
    old = scene.echo()
    scene.sample(20 * MS + 1)
    scene.permit(**old)
    scene.command(MOVING)
    assert scene.judge().cause == GateCause.PERMIT_STALE


def test_a_burned_arming_never_opens_again_however_many_others_burned_since():
    scene = Scene()
    for arming in range(1, 60):
        assert scene.run(arming).state == GateState.OPEN
        scene.sample()
        scene.permit(0, Mode.TRIPPED)
        assert scene.judge().cause == GateCause.NO_PERMIT
    for arming in range(1, 60):
        assert (scene.run(arming).cause, scene.device.codes) == (GateCause.BURNED_ARMING, ZERO)


def test_neither_a_new_trial_nor_a_reset_of_the_stop_revives_a_burned_arming():
    scene = Scene()
    scene.run(codes=MOVING)
    scene.keeper.estop = True
    assert scene.judge().cause == GateCause.ESTOP
    scene.keeper.estop = False
    assert scene.run().cause == GateCause.BURNED_ARMING
    scene.keeper.begin_trial()
    assert scene.run().cause == GateCause.BURNED_ARMING


def test_a_trial_that_begins_while_the_gate_is_open_cuts_and_burns():
    scene = Scene()
    scene.run(codes=MOVING)
    scene.keeper.begin_trial()
    assert scene.device.codes == ZERO
    assert scene.run().cause == GateCause.BURNED_ARMING
    assert scene.run(78).state == GateState.OPEN


def test_an_arming_that_waits_while_a_trial_begins_is_not_burned():
    scene = Scene()
    scene.timeline.tick = -1
    assert scene.run().cause == GateCause.NOT_RUNNING
    scene.keeper.begin_trial()
    scene.timeline.tick = 0
    assert scene.run().state == GateState.OPEN


@pytest.mark.parametrize("key", ["supervisor/permit", "controller/command"])
def test_strangers_never_stop_a_cell(key):
    scene = Scene()
    scene.run(codes=MOVING)
    scene.bus.send(key, header(key, 999, cell="elsewhere"), permit_body() if "permit" in key else command_body())
    scene.bus.send(key, header(key, 999, run=4), permit_body() if "permit" in key else command_body())
    scene.bus.send_bytes(key, b"noise that nobody sent")
    assert scene.judge().state == GateState.OPEN
    assert scene.device.codes == MOVING


def test_a_sender_that_starts_anew_is_a_cut():
    scene = Scene()
    scene.run(codes=MOVING)
    scene.sample()
    scene.permit()
    scene.command(MOVING, epoch=23)
    assert (scene.judge().cause, scene.device.codes) == (GateCause.EPOCH_CHANGED, ZERO)


def test_a_flood_of_foreign_frames_short_of_the_ring_pushes_nothing_out():
    scene = Scene()
    scene.sample()
    scene.permit()
    scene.command(MOVING)
    for _ in range(63):
        scene.bus.send_bytes("controller/command", b"flood")
    assert scene.judge().state == GateState.OPEN
    assert scene.keeper.commands.acceptance.discarded == {"crc": 63}


def test_only_a_command_that_answers_an_older_sample_is_late():
    scene = Scene()
    scene.run()
    old = scene.echo()
    scene.sample()
    scene.permit()
    scene.command(MOVING, **old)
    scene.judge()
    assert [message.header.echo_number for message in scene.late] == [old["echo_number"]]


def test_every_change_of_mind_is_told_once_with_its_numbers():
    scene = Scene()
    scene.run()
    scene.run()
    scene.keeper.force_counts = 400
    scene.run()
    scene.run()
    told = scene.bus.of("plant/gate")
    assert [event.state for event in told] == [GateState.OPEN, GateState.BURNED, GateState.BURNED]
    assert [event.cause for event in told] == [GateCause.NONE, GateCause.FORCE_ABOVE_LIMIT, GateCause.BURNED_ARMING]
    assert told[1].measured == pytest.approx(400 * N_PER_FORCE_COUNT)
    assert told[1].limit == 420.0


@pytest.mark.parametrize(("counts", "limit"), [(518, 518.0), (-1, 0.0)])
def test_an_invalid_force_is_told_with_the_limit_it_broke(counts, limit):
    scene = Scene()
    scene.keeper.force_counts = counts
    assert scene.run().cause == GateCause.FORCE_INVALID
    assert scene.bus.of("plant/gate")[-1][-2:] == (float(counts), limit)


def test_a_decision_without_a_number_tells_zeros():
    assert numbers(int(GateCause.ESTOP), FINE, GateLimits()) == (0.0, 0.0)
