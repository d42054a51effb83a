import time

import pytest

from hydrohil.shared.host import lease
from hydrohil.shared.host.lease import UNCHOSEN, LeaseChoice
from hydrohil.shared.host.wakeups import Probe

MS = 1_000_000


@pytest.fixture
def clock(monkeypatch):
    now = [0]
    monkeypatch.setattr(lease.time, "monotonic_ns", lambda: now[0])
    return now


@pytest.mark.parametrize(
    ("worst_ns", "chosen_ns"),
    [(0, 20 * MS), (20 * MS // 3, 20 * MS), (7 * MS, 21 * MS), (50 * MS, 150 * MS), (67 * MS, 200 * MS), (900 * MS, 200 * MS)],
)
def test_the_lease_is_three_times_the_worst_lateness_within_its_bounds(clock, worst_ns, chosen_ns):
    choice = LeaseChoice(fixed=False)
    assert [choice.after(late_ns, armed=False) for late_ns in (1, worst_ns, 2)] == [UNCHOSEN] * 3
    clock[0] = 2_000_000_000 - 1
    assert choice.after(0, armed=False) == UNCHOSEN
    assert not choice.chosen
    clock[0] = 2_000_000_000
    assert choice.after(0, armed=False) == chosen_ns
    assert choice.chosen


def test_a_lease_grows_with_later_wake_ups_but_never_while_armed_and_never_back(clock):
    choice = LeaseChoice(fixed=False)
    clock[0] = 3_000_000_000
    assert choice.after(0, armed=False) == 20 * MS
    assert choice.after(20 * MS // 3, armed=False) == UNCHOSEN
    assert choice.after(50 * MS, armed=True) == UNCHOSEN
    assert choice.after(0, armed=False) == 150 * MS
    assert choice.after(10 * MS, armed=False) == UNCHOSEN


def test_a_lease_that_is_not_chosen_is_none():
    assert UNCHOSEN == 0


def test_a_fixed_lease_is_never_measured(clock):
    choice = LeaseChoice(fixed=True)
    clock[0] = 3_000_000_000
    assert choice.chosen
    assert choice.after(50 * MS, armed=False) == UNCHOSEN


class FixedProbe:
    """A probe that reports its worst at the third call."""

    def __init__(self, worst_ns):
        self.answers = [None, None, worst_ns]

    def result(self):
        return self.answers.pop(0)


def test_a_probe_decides_when_and_what_it_saw_counts_with_what_the_loop_saw(clock):
    choice = LeaseChoice(FixedProbe(9 * MS), fixed=False)
    clock[0] = 1_000_000_000  # it measures since before this process was ready
    assert [choice.after(8 * MS, armed=False) for _ in range(2)] == [UNCHOSEN] * 2
    assert choice.after(0, armed=False) == 27 * MS
    assert choice.after(10 * MS, armed=False) == 30 * MS


def test_a_probe_measures_in_a_process_of_its_own():
    probe = Probe(0.05, realtime=False)
    deadline = time.monotonic() + 20.0
    while (worst_ns := probe.result()) is None:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    assert 0 < worst_ns < 20_000_000_000
