import os
import subprocess
import sys

import pytest

ROUNDS = """
import os, threading
from shared import realtime
threading.Thread(target=threading.Event().wait, daemon=True).start()
granted = realtime.claim(realtime={realtime}).fifo
def policies():
    return sorted({{os.sched_getscheduler(int(thread)) for thread in os.listdir("/proc/self/task")}})
print(granted)
for clock in ("lockstep", "real", "lockstep"):
    realtime.follow(clock)
    print(*policies())
"""


def scheduled(*, realtime):
    """Whether FIFO was granted, and the policies of all threads after each change of the clock."""
    told = subprocess.run([sys.executable, "-c", ROUNDS.format(realtime=realtime)], capture_output=True, text=True, check=True)
    granted, *policies = told.stdout.split("\n")[:4]
    return granted == "True", [[int(word) for word in line.split()] for line in policies]


@pytest.mark.skipif(not hasattr(os, "SCHED_BATCH"), reason="this system has no SCHED_BATCH")
@pytest.mark.parametrize("realtime", [True, False])
def test_every_thread_is_scheduled_as_the_clock_wants_and_real_time_only_where_it_was_granted(realtime):
    granted, policies = scheduled(realtime=realtime)
    paced = os.SCHED_FIFO if granted else os.SCHED_OTHER
    assert granted <= realtime
    assert policies == [[os.SCHED_BATCH], [paced], [os.SCHED_BATCH]]
