from hypothesis import given
from hypothesis import strategies as st

from hydrohil.shared.contract.codec import Received, Rejected
from hydrohil.shared.transport.acceptance import Acceptance
from hydrohil.shared.transport.protection import (
    FAULTS_PER_S,
    LinkObservation,
    Protection,
    ProtectionLimits,
    ProtectionMemory,
    protection_step,
    worst,
)
from tests.support.wire_scene import command_body, header

SECOND = 1_000_000_000
LIMITS = ProtectionLimits()


def frame(seq, epoch=1):
    return Received(0, "controller/command", header("controller/command", seq, epoch=epoch), command_body())


def corrupt(**changes):
    return Rejected(0, "controller/command", "crc", "", header("controller/command", 9, **({"epoch": 1} | changes)))


def counted(faults_at, now_ns, limits=LIMITS):
    memory = ProtectionMemory()
    for at_ns, faults in faults_at:
        memory = protection_step(memory, limits, faults, at_ns)
    return len(protection_step(memory, limits, 0, now_ns).at_ns)


def test_a_fault_is_remembered_for_less_than_a_second():
    assert counted([(0, 1)], SECOND - 1) == 1
    assert counted([(0, 1)], SECOND) == 0


def test_two_faults_a_second_apart_are_two_accidents_and_two_within_it_are_a_cause():
    assert counted([(5, 1), (SECOND + 5, 1)], SECOND + 5) == 1
    assert counted([(5, 1), (SECOND + 4, 1)], SECOND + 4) == 2


def test_faults_of_one_call_all_count_and_more_than_eight_count_as_eight():
    assert [counted([(0, faults)], 0) for faults in (0, 1, 2, 7, 8, 9, 10**9)] == [0, 1, 2, 7, 8, 8, 8]


def test_the_newest_are_kept():
    memory = protection_step(ProtectionMemory(tuple(range(8, 0, -1))), LIMITS, 3, 20)
    assert memory.at_ns == (20, 20, 20, 8, 7, 6, 5, 4)


def test_a_clock_that_was_set_back_forgets_what_it_cannot_date():
    assert counted([(10 * SECOND, 5)], 3) == 0
    assert counted([(3, 1)], 2) == 0
    assert counted([(3, 1)], 3) == 1


@given(st.lists(st.tuples(st.integers(0, SECOND // 2), st.integers(0, 3)), max_size=20))
def test_as_many_count_as_came_within_the_second_up_to_eight(steps):
    now_ns, came, memory = 0, [], ProtectionMemory()
    for wait_ns, faults in steps:
        now_ns += wait_ns
        came += [now_ns] * faults
        memory = protection_step(memory, LIMITS, faults, now_ns)
        assert len(memory.at_ns) == min(8, sum(now_ns - at < SECOND for at in came))


def test_each_fault_counts_once_and_for_a_second():
    acceptance = Acceptance()
    watch = Protection(acceptance, LIMITS)
    assert watch.observe(0) == (0, 0)
    for message in (frame(0), frame(0), frame(1), corrupt(), corrupt()):
        acceptance.take(message)
    assert watch.observe(10) == LinkObservation(faults=3, epoch_conflicts=0)
    assert watch.observe(SECOND + 9) == (3, 0)
    assert watch.observe(SECOND + 10) == (0, 0)
    acceptance.take(frame(0, epoch=2))
    acceptance.take(frame(2))
    assert watch.observe(SECOND + 11) == LinkObservation(faults=0, epoch_conflicts=2)
    acceptance.take(frame(3))
    assert watch.observe(2 * SECOND + 10) == LinkObservation(faults=0, epoch_conflicts=3)
    assert watch.observe(2 * SECOND + 11) == LinkObservation(faults=0, epoch_conflicts=1)


def test_what_came_before_the_first_look_counts():
    acceptance = Acceptance()
    for message in (frame(0), frame(0), frame(0, epoch=2)):
        acceptance.take(message)
    assert Protection(acceptance, LIMITS).observe(0) == LinkObservation(faults=1, epoch_conflicts=1)


def test_one_a_second_is_borne():
    assert (FAULTS_PER_S, LIMITS.window_ns) == (1, SECOND)


def test_faults_of_different_links_are_not_added():
    assert worst(LinkObservation(1, 0), LinkObservation(1, 2)) == LinkObservation(1, 2)
    assert worst(LinkObservation(3, 1), LinkObservation(1, 0)) == LinkObservation(3, 1)
