import pytest

from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.counters import Counters
from hydrohil.services.plant.device import Timeline
from hydrohil.services.plant.gatekeeper import Gatekeeper
from hydrohil.shared.contract.codec import encode
from hydrohil.shared.contract.messages import GateCause, GateState, Mode
from hydrohil.shared.contract.topics import expression
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.units import SUBSTEP_NS
from tests.support.wire_scene import CELL, ZERO, FakeBus, command_body, header, permit_body

MS = 1_000_000
MOVING = (2100, 2000, 2048)


class FakeDevice:
    def __init__(self):
        self.codes, self.watchdog_substeps = ZERO, None

    def write(self, codes):
        self.codes = codes

    def watchdog(self, substeps):
        self.watchdog_substeps = substeps


class Scene:
    """A gatekeeper whose plant issues a sample every 4.5 ms; permits and commands answer it."""

    def __init__(self):
        self.bus, self.device, self.timeline = FakeBus(), FakeDevice(), Timeline()
        self.keeper = Gatekeeper(self.bus, self.device, self.timeline, GateLimits(), Counters())
        self.timeline.tick = 0
        self.now_ns = self.seq = self.force_counts = 0
        self.late = []

    def sample(self, period_ns=4_500_000):
        self.now_ns += period_ns
        self.timeline.number += 1
        self.keeper.issue_sample(self.timeline.number, self.timeline.number, self.now_ns, self.force_counts)

    def echo(self):
        return {"echo_number": self.timeline.number, "echo_time_ns": self.timeline.number}

    def permit(self, arming_id=77, mode=Mode.RUNNING, **changes):
        self.seq += 1
        self.bus.send(
            "supervisor/permit",
            header("supervisor/permit", self.seq, arming_id=arming_id, **(self.echo() | changes)),
            permit_body(mode),
        )

    def command(self, codes=ZERO, arming_id=77, **changes):
        self.seq += 1
        self.bus.send(
            "controller/command",
            header("controller/command", self.seq, arming_id=arming_id, **(self.echo() | changes)),
            command_body(codes),
        )

    def judge(self, **changes):
        self.keeper.receive(self.now_ns, at_latch=True, late=self.late.append)
        self.keeper.judge(self.now_ns, **({"at_latch": True} | changes))
        return self.keeper.gate

    def run(self, arming_id=77, codes=ZERO):
        self.sample()
        self.permit(arming_id)
        self.command(codes, arming_id)
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


def test_a_revoked_arming_never_opens_again_however_many_others_revoked_since():
    scene = Scene()
    for arming_id in range(1, 60):
        assert scene.run(arming_id).state == GateState.OPEN
        scene.sample()
        scene.permit(0, Mode.TRIPPED)
        assert scene.judge().cause == GateCause.NO_PERMIT
    for arming_id in range(1, 60):
        assert (scene.run(arming_id).cause, scene.device.codes) == (GateCause.REVOKED_ARMING, ZERO)


def test_neither_a_new_trial_nor_a_reset_of_the_stop_revives_a_revoked_arming():
    scene = Scene()
    scene.run(codes=MOVING)
    scene.keeper.stop(scene.now_ns)
    assert scene.judge().cause == GateCause.ESTOP
    scene.keeper.release_stop(scene.now_ns)
    assert scene.run().cause == GateCause.REVOKED_ARMING
    scene.keeper.begin_trial()
    assert scene.run().cause == GateCause.REVOKED_ARMING


def test_a_trial_that_begins_while_the_gate_is_open_cuts_and_revokes():
    scene = Scene()
    scene.run(codes=MOVING)
    scene.keeper.begin_trial()
    assert scene.device.codes == ZERO
    assert scene.run().cause == GateCause.REVOKED_ARMING
    assert scene.run(78).state == GateState.OPEN


def test_an_arming_that_waits_while_a_trial_begins_is_not_revoked():
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
    assert scene.keeper.permits.acceptance.other_run == scene.keeper.commands.acceptance.other_run == 0
    scene.bus.send(key, header(key, 999, cell="elsewhere"), permit_body() if "permit" in key else command_body())
    scene.bus.send(key, header(key, 999, run=4), permit_body() if "permit" in key else command_body())
    scene.bus.send_bytes(key, b"noise that nobody sent")
    assert scene.judge().state == GateState.OPEN
    assert scene.device.codes == MOVING
    inbox = scene.keeper.permits if "permit" in key else scene.keeper.commands
    assert inbox.acceptance.other_run == 1


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


def test_every_change_of_the_gate_is_published_once_with_its_numbers():
    scene = Scene()
    scene.run()
    scene.run()
    scene.force_counts = 400
    scene.run()
    scene.run()
    events = scene.bus.of("plant/gate")
    assert [event.state for event in events] == [GateState.OPEN, GateState.REVOKED, GateState.REVOKED]
    assert [event.cause for event in events] == [GateCause.NONE, GateCause.FORCE_ABOVE_LIMIT, GateCause.REVOKED_ARMING]
    assert events[1].measured == pytest.approx(400 * UNIMATE.force.scale)
    assert events[1].limit == 420.0


@pytest.mark.parametrize(("counts", "limit"), [(518, 518.0), (-1, 0.0)])
def test_an_invalid_force_is_published_with_the_limit_it_broke(counts, limit):
    scene = Scene()
    scene.force_counts = counts
    assert scene.run().cause == GateCause.FORCE_INVALID
    assert scene.bus.of("plant/gate")[-1][-2:] == (float(counts), limit)


def corrupt(scene, key="controller/command", **changes):
    """A frame of the bound sender with one bit of its body wrong."""
    scene.seq += 1
    body = permit_body() if "permit" in key else command_body()
    frame = bytearray(encode(expression(CELL, key), header(key, scene.seq, **(scene.echo() | changes)), body))
    frame[-5] ^= 1
    scene.bus.send_bytes(key, bytes(frame))


@pytest.mark.parametrize("key", ["supervisor/permit", "controller/command"])
def test_one_corrupt_frame_a_second_is_survived_and_a_second_one_cuts_and_revokes(key):
    scene = Scene()
    scene.run(codes=MOVING)
    corrupt(scene, key)
    assert scene.run(codes=MOVING).state == GateState.OPEN
    while scene.now_ns < 1_004_500_000:
        scene.sample()
        scene.permit()
        scene.command(MOVING)
        assert scene.judge().state == GateState.OPEN
    corrupt(scene, key)
    assert scene.run(codes=MOVING).state == GateState.OPEN
    corrupt(scene, key)
    assert (scene.run(codes=MOVING).cause, scene.device.codes) == (GateCause.LINK_FAULTS, ZERO)
    scene.now_ns += 2_000_000_000
    assert scene.run(codes=MOVING).cause == GateCause.REVOKED_ARMING
    assert scene.bus.of("plant/gate")[1][-2:] == (2.0, 1.0)


def test_one_fault_on_each_link_is_no_cause():
    scene = Scene()
    scene.run(codes=MOVING)
    corrupt(scene, "supervisor/permit")
    corrupt(scene, "controller/command")
    assert scene.run(codes=MOVING).state == GateState.OPEN


def test_corrupt_frames_of_strangers_are_counted_and_stop_nobody():
    scene = Scene()
    scene.run(codes=MOVING)
    for _ in range(20):
        corrupt(scene, epoch=99)
        corrupt(scene, "supervisor/permit", cell="left")
    assert scene.run(codes=MOVING).state == GateState.OPEN
    assert scene.keeper.commands.acceptance.discarded == {"crc": 20}


def test_a_repeated_command_stops_a_cell_only_if_it_comes_again_and_again():
    scene = Scene()
    scene.run(codes=MOVING)
    scene.sample()
    scene.permit()
    scene.command(MOVING)
    scene.seq -= 1
    scene.command((3000, 3000, 3000))
    assert scene.judge().state == GateState.OPEN
    assert scene.device.codes == MOVING
    scene.seq -= 1
    scene.command(MOVING)
    assert (scene.judge().cause, scene.device.codes) == (GateCause.LINK_FAULTS, ZERO)


def test_two_controllers_shut_the_gate_before_it_was_ever_open():
    scene = Scene()
    scene.timeline.tick = -1
    scene.run()
    for _ in range(2):
        scene.sample()
        scene.permit()
        scene.command(epoch=23)
        scene.command()
        scene.judge()
    assert scene.keeper.gate.cause == GateCause.TWO_PUBLISHERS
    assert 77 in scene.keeper.revoked
    scene.timeline.tick = 0
    assert scene.run().state == GateState.REVOKED


def test_a_cut_publishes_how_many_frames_were_accepted_and_discarded():
    scene = Scene()
    scene.run(codes=MOVING)
    assert not scene.bus.of("plant/link_stats")
    scene.bus.send_bytes("controller/command", b"noise that nobody sent")
    scene.judge()
    scene.keeper.stop(scene.now_ns)
    ((number, (commands, permits)),) = scene.bus.of("plant/link_stats")
    assert number == scene.timeline.number
    assert (commands.topic, commands.accepted, commands.crc) == ("controller/command", 1, 1)
    assert (permits.topic, permits.accepted, permits.crc) == ("supervisor/permit", 1, 0)


def test_the_last_cut_is_dated_on_the_plants_grid_and_by_its_clock_and_a_new_trial_forgets_it():
    scene = Scene()
    scene.run(codes=MOVING)
    scene.timeline.substep, scene.now_ns = 162, 9_000_000
    scene.keeper.stop(scene.now_ns)
    assert last_cut(scene.keeper) == ("ESTOP", 162 * SUBSTEP_NS, 9_000_000)
    scene.timeline.substep, scene.now_ns = 163, 9_000_001
    scene.judge()
    assert last_cut(scene.keeper) == ("ESTOP", 162 * SUBSTEP_NS, 9_000_000)
    scene.keeper.begin_trial()
    assert last_cut(scene.keeper) == ("NONE", 0, 0)


def last_cut(keeper):
    status = keeper.status()
    return status["last_cut"], status["last_cut_ns"], status["last_cut_clock_ns"]


def test_an_emergency_stop_cuts_at_once_and_its_release_alone_opens_nothing():
    scene = Scene()
    scene.run(codes=MOVING)
    scene.keeper.stop(scene.now_ns)
    assert (scene.device.codes, scene.keeper.gate.cause, scene.keeper.stop_pressed) == (ZERO, GateCause.ESTOP, True)
    assert scene.keeper.gate.open_samples == 0
    scene.keeper.release_stop(scene.now_ns)
    assert (scene.device.codes, scene.keeper.gate.cause) == (ZERO, GateCause.REVOKED_ARMING)
    assert not scene.keeper.stop_pressed


def test_neither_a_stop_nor_its_release_nor_a_late_command_counts_as_a_sample_of_the_open_gate():
    scene = Scene()
    scene.run(codes=MOVING)
    assert scene.keeper.gate.open_samples == 1
    scene.keeper.release_stop(scene.now_ns)
    scene.keeper.judge_late(scene.now_ns, 3)
    assert scene.keeper.gate.open_samples == 1


def test_another_lease_holds_for_permits_and_commands_and_for_the_watchdog_of_the_device():
    scene = Scene()
    scene.keeper.set_lease(30 * MS)
    assert (scene.keeper.limits.permit_ttl_ns, scene.keeper.limits.command_ttl_ns) == (30 * MS, 30 * MS)
    assert scene.device.watchdog_substeps == 600
    scene.run(codes=MOVING)
    scene.now_ns += 30 * MS
    assert scene.judge().state == GateState.OPEN
    scene.now_ns += 1
    assert scene.judge().cause == GateCause.PERMIT_STALE


def test_it_is_armed_while_the_gate_is_bound_or_a_fresh_permit_has_an_arming_id():
    scene = Scene()
    assert not scene.keeper.armed(scene.now_ns)
    scene.run()
    assert scene.keeper.arming_id == 77
    assert scene.keeper.armed(scene.now_ns + 10**12)  # bound, however old the permit is
    scene.keeper.stop(scene.now_ns)
    assert scene.keeper.armed(scene.now_ns) and scene.keeper.armed(scene.now_ns + 20 * MS)
    assert not scene.keeper.armed(scene.now_ns + 20 * MS + 1)
    assert not scene.keeper.armed(scene.now_ns - 1)  # its echo is impossible then
    scene.sample()
    scene.permit(0, Mode.DISARMED)
    scene.judge()
    assert not scene.keeper.armed(scene.now_ns)


def test_only_a_permit_to_run_announces_a_trial():
    scene = Scene()
    assert scene.keeper.announced_sample() is None
    scene.sample()
    scene.permit(mode=Mode.ARMED)
    scene.judge()
    assert scene.keeper.announced_sample() is None
    scene.run()
    assert scene.keeper.announced_sample() == permit_body().first_sample == 0


def test_an_answer_to_a_sample_answers_those_before_it_too():
    scene = Scene()
    scene.sample()
    scene.permit()
    scene.judge()
    assert scene.keeper.permit_answers(1) and not scene.keeper.permit_answers(2)
    assert not scene.keeper.command_answers(1)
    scene.command()
    scene.judge()
    assert scene.keeper.command_answers(0) and scene.keeper.command_answers(1) and not scene.keeper.command_answers(2)


def test_the_peers_are_connected_once_a_permit_and_a_command_were_accepted():
    scene = Scene()
    assert not scene.keeper.connected
    scene.sample()
    scene.permit()
    scene.judge()
    assert not scene.keeper.connected
    scene.command()
    scene.judge()
    assert scene.keeper.connected
    other = Scene()
    other.sample()
    other.command()
    other.judge()
    assert not other.keeper.connected


def test_the_status_reports_gate_and_stop_and_what_was_revoked():
    scene = Scene()
    scene.run(codes=MOVING)
    assert scene.keeper.status() | {"link_stats": {}} == {
        "gate": GateState.OPEN,
        "gate_cause": "NONE",
        "last_cut": "NONE",
        "last_cut_ns": 0,
        "last_cut_clock_ns": 0,
        "revoked_arming_ids": 0,
        "estop": False,
        "link_stats": {},
    }
    assert set(scene.keeper.status()["link_stats"]) == {"controller/command", "supervisor/permit"}
    scene.keeper.stop(scene.now_ns)
    status = scene.keeper.status()
    assert (status["gate"], status["gate_cause"], status["revoked_arming_ids"], status["estop"]) == (2, "ESTOP", 1, True)
