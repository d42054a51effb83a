"""When the last sample goes out once more: at two instants before the next, while there is time and the answers are quick."""

import pytest

from hydrohil.services.plant import warmup as warmups
from hydrohil.services.plant.warmup import LEADS_NS, REST, SLOW, Warmups
from hydrohil.shared.host import clock
from hydrohil.shared.host.clock import Grid
from hydrohil.shared.units import SUBSTEP_NS
from tests.support.supervisor_scene import sample
from tests.support.wire_scene import FakeBus

DUE = 90  # sub-steps
DUE_NS = DUE * SUBSTEP_NS
LATCH_NS = 3_600_000
SLOW_NS = LATCH_NS // SLOW + 1


class Wall:
    """Time that passes only while somebody sleeps."""

    def __init__(self):
        self.now_ns = 0

    def monotonic_ns(self):
        return self.now_ns

    def sleep(self, seconds):
        self.now_ns += round(seconds * 1e9)


class Bus(FakeBus):
    """Keeps when something was sent."""

    def __init__(self, wall):
        super().__init__("plant")
        self.wall, self.sent = wall, []

    def publish(self, key, body, echo=(-1, 0)):
        self.sent.append((self.wall.now_ns, key, body, echo))


@pytest.fixture
def wall(monkeypatch):
    clock_of_test = Wall()
    for module in (warmups, clock):
        monkeypatch.setattr(module, "time", clock_of_test)
    return clock_of_test


def test_each_goes_out_at_its_instant_and_carries_the_last_sample(wall):
    bus, last = Bus(wall), sample(41)
    frames = Warmups(bus, Grid(), enabled=True)
    frames.send(DUE, last)
    assert bus.sent == [(DUE_NS - lead_ns, "plant/warmup", last, (41, last.time_ns)) for lead_ns in LEADS_NS]
    assert frames.sent == len(LEADS_NS)


@pytest.mark.parametrize(("early_ns", "sent"), [(1, 2), (0, 1), (-1, 1), (LEADS_NS[1] - LEADS_NS[0], 0)])
def test_one_whose_instant_has_passed_is_left_out(wall, early_ns, sent):
    bus, grid = Bus(wall), Grid()
    wall.now_ns = DUE_NS - LEADS_NS[0] - early_ns
    Warmups(bus, grid, enabled=True).send(DUE, sample(41))
    assert len(bus.sent) == sent


def rested(frames, wall, *, after_ns):
    """Samples until warm-up frames go out again, each answered `after_ns`."""
    for number in range(REST + 2):
        sent = frames.sent
        frames.send(Grid().substep_at(wall.now_ns) + (number + 1) * DUE, sample(number))
        if frames.sent > sent:
            return number
        frames.observe(after_ns, LATCH_NS)
    return None


def test_they_rest_after_two_slow_answers_in_a_row_and_then_come_again(wall):
    frames = Warmups(Bus(wall), Grid(), enabled=True)
    frames.observe(SLOW_NS, LATCH_NS)
    frames.observe(LATCH_NS, LATCH_NS)
    assert rested(frames, wall, after_ns=SLOW_NS - 1) == REST


@pytest.mark.parametrize("answers", [(SLOW_NS,), (SLOW_NS, SLOW_NS - 1, SLOW_NS), (SLOW_NS - 1,) * 9, (LATCH_NS, 0)])
def test_they_do_not_rest_after_a_single_slow_answer(wall, answers):
    frames = Warmups(Bus(wall), Grid(), enabled=True)
    for after_ns in answers:
        frames.observe(after_ns, LATCH_NS)
    assert rested(frames, wall, after_ns=0) == 0


def test_they_go_on_resting_while_answers_stay_slow(wall):
    frames = Warmups(Bus(wall), Grid(), enabled=True)
    frames.observe(SLOW_NS, LATCH_NS)
    frames.observe(SLOW_NS, LATCH_NS)
    assert rested(frames, wall, after_ns=SLOW_NS) is None


def test_where_they_are_not_enabled_none_is_sent(wall):
    frames = Warmups(Bus(wall), Grid(), enabled=False)
    frames.send(DUE, sample(41))
    assert frames.sent == 0 and wall.now_ns == 0
