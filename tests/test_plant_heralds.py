"""When the last sample goes out once more: at two instants before the next, while there is time and whoever answers keeps up."""

import pytest
from supervisor_scene import sample
from wire_scene import FakeBus

from services.plant import heralds
from services.plant.heralds import LEADS_NS, REST, Heralds
from shared import clock
from shared.clock import Grid
from shared.units import SUBSTEP_NS

DUE = 90  # sub-steps
DUE_NS = DUE * SUBSTEP_NS


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
    made = Wall()
    for module in (heralds, clock):
        monkeypatch.setattr(module, "time", made)
    return made


def test_each_goes_out_at_its_instant_and_tells_the_last_sample(wall):
    bus, last = Bus(wall), sample(41)
    made = Heralds(bus, Grid(), wanted=True)
    made.send(DUE, last)
    assert bus.sent == [(DUE_NS - lead_ns, "plant/herald", last, (41, last.time_ns)) for lead_ns in LEADS_NS]
    assert made.sent == len(LEADS_NS)


@pytest.mark.parametrize(("early_ns", "sent"), [(1, 2), (0, 1), (-1, 1), (LEADS_NS[1] - LEADS_NS[0], 0)])
def test_one_whose_instant_has_passed_is_left_out(wall, early_ns, sent):
    bus, grid = Bus(wall), Grid()
    wall.now_ns = DUE_NS - LEADS_NS[0] - early_ns
    Heralds(bus, grid, wanted=True).send(DUE, sample(41))
    assert len(bus.sent) == sent


def test_they_rest_after_a_sample_that_was_not_answered_and_then_come_again(wall):
    made, grid = Heralds(Bus(wall), Grid(), wanted=True), Grid()
    made.heed(answered=False)
    for number in range(REST):
        made.send(DUE * (number + 1), sample(number))
        assert made.sent == 0
        made.heed(answered=True)
    made.send(grid.substep_at(wall.now_ns) + DUE, sample(REST))
    assert made.sent == len(LEADS_NS)


def test_whoever_wants_none_gets_none(wall):
    made = Heralds(Bus(wall), Grid(), wanted=False)
    made.send(DUE, sample(41))
    assert made.sent == 0 and wall.now_ns == 0
