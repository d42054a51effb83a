import pytest

from hydrohil.shared.host import clock
from hydrohil.shared.host.clock import SLACK_NS, Grid, sleep_until

PERIOD = 90 * 50_000


class Wall:
    """A clock that stands still but for sleeping, which oversleeps by `late_ns`."""

    def __init__(self):
        self.now_ns, self.late_ns, self.slept = 1_000_000_000, 0, []

    def sleep(self, seconds):
        self.slept.append(seconds)
        self.now_ns += round(seconds * 1e9) + self.late_ns


@pytest.fixture
def wall(monkeypatch):
    wall = Wall()
    monkeypatch.setattr(clock.time, "monotonic_ns", lambda: wall.now_ns)
    monkeypatch.setattr(clock.time, "sleep", wall.sleep)
    return wall


def test_sleeping_ends_at_the_deadline_and_returns_how_late(wall):
    assert sleep_until(wall.now_ns + 100) == 0
    wall.late_ns = 30
    assert sleep_until(wall.now_ns + 100) == 30


def test_a_deadline_that_has_passed_is_not_slept_for(wall):
    assert sleep_until(wall.now_ns - 70) == 70
    assert wall.slept == []


def test_the_grid_is_absolute_and_does_not_drift(wall):
    grid, start = Grid(), wall.now_ns
    wall.late_ns = 1000
    for i in range(1, 101):
        assert grid.wait(90 * i) == 1000
        assert wall.now_ns == start + PERIOD * i + 1000


@pytest.mark.parametrize(("late_ns", "shift_ns"), [(SLACK_NS, 0), (SLACK_NS + 1, SLACK_NS + 1), (50_000_000, 50_000_000)])
def test_only_what_was_overrun_beyond_the_slack_shifts_the_rest_of_the_grid(wall, late_ns, shift_ns):
    grid, start = Grid(), wall.now_ns
    wall.late_ns = late_ns
    assert grid.wait(90) == late_ns
    wall.late_ns = 0
    grid.wait(180)
    assert wall.now_ns == start + 2 * PERIOD + shift_ns
    assert grid.instant_ns(180) == start + 2 * PERIOD + shift_ns


def test_an_instant_belongs_to_the_sub_step_under_way(wall):
    grid = Grid()
    assert [grid.substep_at(wall.now_ns + ns) for ns in (0, 49_999, 50_000, -1)] == [0, 0, 1, -1]


def test_a_grid_restarted_has_its_sub_step_now(wall):
    grid = Grid()
    wall.now_ns += 12_345
    grid.restart_at(1000)
    assert grid.instant_ns(1000) == wall.now_ns
    assert grid.wait(1000) == 0
