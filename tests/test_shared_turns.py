import threading

import pytest

from shared.turns import Turns


def test_who_finds_the_turn_taken_returns_at_once_and_its_cause_is_served_by_who_has_it():
    begun, go_on, served = threading.Event(), threading.Event(), []

    def step() -> None:
        served.append(threading.current_thread().name)
        begun.set()
        go_on.wait(10.0)

    turns = Turns(step)
    holder = threading.Thread(target=turns.take, name="holder")
    holder.start()
    assert begun.wait(10.0)
    turns.take()  # comes while the other steps: it would hang here if it waited
    assert served == ["holder"]
    go_on.set()
    holder.join(10.0)
    assert served == ["holder", "holder"]


def test_however_many_find_it_taken_one_more_step_serves_them_all():
    served = []

    def step() -> None:
        served.append(len(served))
        if len(served) == 1:
            for _ in range(5):
                turns.take()

    turns = Turns(step)
    turns.take()
    assert served == [0, 1]


def test_no_cause_is_lost_between_threads():
    left, done = [0] * 4, []

    def step() -> None:
        for i, count in enumerate(left):
            if count:
                left[i] = 0
                done.append(count)

    turns = Turns(step)

    def arrive(i: int) -> None:
        for _ in range(2000):
            left[i] += 1  # only this thread counts up, and only a step clears
            turns.take()

    threads = [threading.Thread(target=arrive, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30.0)
    assert left == [0] * 4 and sum(done) <= 8000 and done


def test_work_between_steps_excludes_them_and_what_came_meanwhile_is_served_after_it():
    order = []
    turns = Turns(lambda: order.append("step"))

    def work() -> None:
        turns.take()
        order.append("work")

    turns.between(work)
    assert order == ["work", "step"]


def test_a_step_that_raises_gives_the_turn_back():
    outcomes = iter([ValueError("broken"), None])

    def step() -> None:
        outcome = next(outcomes)
        if outcome is not None:
            raise outcome

    turns = Turns(step)
    with pytest.raises(ValueError, match="broken"):
        turns.take()
    turns.take()
    assert next(outcomes, "all taken") == "all taken"
