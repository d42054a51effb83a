import os
import subprocess
import sys

import pytest

from hydrohil.shared.host.realtime import FIFO_PRIORITY, PLANT_PRIORITY

ROUNDS = """
import os, threading
from hydrohil.shared.host import realtime
threading.Thread(target=threading.Event().wait, daemon=True).start()
granted = realtime.request_realtime(realtime={realtime}).fifo
def policies():
    return sorted({{os.sched_getscheduler(int(thread)) for thread in os.listdir("/proc/self/task")}})
print(granted)
for clock in ("lockstep", "real", "lockstep"):
    realtime.set_scheduling(clock)
    print(*policies())
"""


def scheduled(*, realtime):
    """Whether FIFO was granted, and the policies of all threads after each change of the clock."""
    output = subprocess.run([sys.executable, "-c", ROUNDS.format(realtime=realtime)], capture_output=True, text=True, check=True)
    granted, *policies = output.stdout.split("\n")[:4]
    return granted == "True", [[int(word) for word in line.split()] for line in policies]


@pytest.mark.skipif(not hasattr(os, "SCHED_BATCH"), reason="this system has no SCHED_BATCH")
@pytest.mark.parametrize("realtime", [True, False])
def test_every_thread_is_scheduled_as_the_clock_wants_and_real_time_only_where_it_was_granted(realtime):
    granted, policies = scheduled(realtime=realtime)
    paced = os.SCHED_FIFO if granted else os.SCHED_OTHER
    assert granted <= realtime
    assert policies == [[os.SCHED_BATCH], [paced], [os.SCHED_BATCH]]


SETTLED = """
import os
from hydrohil.shared.host import realtime
granted = realtime.request_realtime(realtime={realtime}, priority={priority}).fifo
allowed = sorted(os.sched_getaffinity(0))
print(granted, *allowed)
realtime.pin_cpu({number}, alone={alone})
print(*sorted(os.sched_getaffinity(0)))
realtime.set_scheduling("lockstep")
realtime.set_scheduling("real")
print(os.sched_getparam(0).sched_priority)
"""


def settled(number, *, alone, realtime=True, priority=FIFO_PRIORITY):
    """Whether FIFO was granted, the processors allowed, those left, and the priority after a change of clocks."""
    line = SETTLED.format(number=number, alone=alone, realtime=realtime, priority=priority)
    output = subprocess.run([sys.executable, "-c", line], capture_output=True, text=True, check=True).stdout.splitlines()
    granted, *allowed = output[0].split()
    return granted == "True", allowed, output[1].split(), int(output[2])


@pytest.mark.parametrize("number", [0, 1, 7])
def test_one_takes_a_processor_that_another_leaves_and_neighbours_take_theirs_in_turn(number):
    granted, allowed, taken, _ = settled(number, alone=True)
    _, _, left, _ = settled(number, alone=False)
    if not granted or len(allowed) == 1:
        assert taken == left == allowed
    else:
        assert taken == [allowed[-1 - number % len(allowed)]]
        assert sorted(left + taken, key=int) == allowed


def test_without_real_time_scheduling_a_process_stays_free():
    _, allowed, left, priority = settled(0, alone=True, realtime=False)
    assert (left, priority) == (allowed, 0)


def test_the_plant_goes_before_who_answers_it_and_keeps_that_from_clock_to_clock():
    granted, *_, priority = settled(0, alone=True, priority=PLANT_PRIORITY)
    assert priority == (PLANT_PRIORITY if granted else 0)
    assert PLANT_PRIORITY > FIFO_PRIORITY


WITHOUT_REALTIME = """
import os, threading
from hydrohil.shared.host import realtime
def scheduled():
    return os.sched_getscheduler(0), os.sched_getparam(0).sched_priority
other = threading.Thread(target=threading.Event().wait, daemon=True)
realtime.request_realtime(realtime={realtime})
other.start()
before = scheduled()
try:
    with realtime.without_realtime():
        assert scheduled() == (os.SCHED_OTHER, 0)
        assert os.sched_getscheduler(other.native_id) == before[0]
        raise ValueError
except ValueError:
    assert scheduled() == before
"""


@pytest.mark.parametrize("realtime", [True, False])
def test_work_without_realtime_gives_way_in_its_own_thread_alone_and_ends_as_it_began(realtime):
    subprocess.run([sys.executable, "-c", WITHOUT_REALTIME.format(realtime=realtime)], check=True)
