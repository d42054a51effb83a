import threading
import time
from collections import deque

import pytest

from hydrohil.shared.transport.step_lock import StepLock


def test_a_thread_that_finds_another_stepping_returns_at_once_and_the_other_steps_for_it():
    begun, go_on, served = threading.Event(), threading.Event(), []

    def step() -> None:
        served.append(threading.current_thread().name)
        begun.set()
        go_on.wait(10.0)

    step_lock = StepLock(step)
    holder = threading.Thread(target=step_lock.step, name="holder")
    holder.start()
    assert begun.wait(10.0)
    step_lock.step()  # comes while the other steps: it would hang here if it waited
    assert served == ["holder"]
    go_on.set()
    holder.join(10.0)
    assert served == ["holder", "holder"]


def test_however_many_causes_come_during_a_step_one_more_step_serves_them_all():
    served = []

    def step() -> None:
        served.append(len(served))
        if len(served) == 1:
            for _ in range(5):
                step_lock.step()

    step_lock = StepLock(step)
    step_lock.step()
    assert served == [0, 1]


def test_no_cause_is_lost_between_threads():
    brought, done = deque(), []

    def step() -> None:
        while brought:
            done.append(brought.popleft())

    step_lock = StepLock(step)

    def bring() -> None:
        for i in range(2000):
            brought.append(i)
            step_lock.step()

    threads = [threading.Thread(target=bring) for _ in range(4)]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        step_lock.run_between_steps(lambda: None)
    assert not brought
    assert len(done) == 8000


def test_work_comes_before_the_step_and_what_came_during_it_is_in_that_step():
    order = []
    step_lock = StepLock(lambda: order.append("step"))

    def work() -> None:
        step_lock.step()
        order.append("work")

    assert not step_lock.run_between_steps(work)
    assert order == ["work", "step"]


def test_the_serving_thread_learns_of_what_came_while_it_stepped():
    steps = []

    def step() -> None:
        steps.append(1)
        if len(steps) == 1:
            step_lock.step()

    step_lock = StepLock(step)
    assert step_lock.run_between_steps(lambda: None)
    assert not step_lock.run_between_steps(lambda: None)
    assert len(steps) == 2


def test_a_flood_that_gives_cause_at_every_step_does_not_lock_out_the_serving_thread():
    order = []

    def step() -> None:
        order.append(f"step by {threading.current_thread().name}")
        if len(order) == 1:
            serving.start()
            deadline = time.monotonic() + 5.0
            while not step_lock._service_waits and time.monotonic() < deadline:
                time.sleep(0.001)
            step_lock.step()  # as another thread would: something has come again

    step_lock = StepLock(step)
    serving = threading.Thread(target=step_lock.run_between_steps, args=(lambda: order.append("work"),), name="server")
    flooded = threading.Thread(target=step_lock.step, name="transport")
    flooded.start()
    flooded.join(10.0)
    serving.join(10.0)
    assert order == ["step by transport", "work", "step by server"]
    step_lock.step()
    assert len(order) == 4


def test_a_step_that_raises_releases_the_lock():
    outcomes = iter([ValueError("broken"), None])

    def step() -> None:
        outcome = next(outcomes)
        if outcome is not None:
            raise outcome

    step_lock = StepLock(step)
    with pytest.raises(ValueError, match="broken"):
        step_lock.step()
    step_lock.step()
    assert next(outcomes, "all taken") == "all taken"
