"""Which faults act at which sample, scheduled and by hand."""

import pytest

from hydrohil.services.plant.faults import FIRST, drawn, fault_row
from hydrohil.services.plant.injection import Injection
from hydrohil.shared.contract.faults import Fault, ticks_of
from hydrohil.shared.contract.messages import NO_TRIAL

PERIOD_NS = 4_500_000
STUCK, OFFSET = Fault("stuck", "force", 0.45, 0.09), Fault("offset", "encoder_rotate", 0.0, 0.0, 5.0)


def scheduled(*faults):
    injection = Injection()
    injection.schedule(faults, 3, PERIOD_NS)
    return injection


def test_without_faults_the_table_is_empty():
    assert scheduled().at(5, NO_TRIAL) == scheduled().at(5, 3) == ()


@pytest.mark.parametrize(("tick", "acts"), [(NO_TRIAL, False), (99, False), (100, True), (119, True), (120, False)])
def test_a_scheduled_fault_acts_at_its_ticks_and_never_outside_a_trial(tick, acts):
    injection = scheduled(STUCK)
    assert bool(injection.at(1234, tick)) is acts
    assert injection.acting == ((STUCK,) if acts else ())
    assert injection.waiting == ()


@pytest.mark.parametrize("tick_of_first", [NO_TRIAL, 40])
def test_a_fault_by_hand_begins_at_the_next_sample_and_lasts_its_time_in_or_outside_a_trial(tick_of_first):
    injection, fault = scheduled(), Fault("offset", "force", 0.0, 0.018, 30.0)
    injection.inject(fault, 1000)
    assert injection.waiting == (fault,)
    acting = []
    for number in range(999, 1008):
        tick = NO_TRIAL if tick_of_first == NO_TRIAL else tick_of_first + number - 999
        if injection.at(number, tick):
            acting.append(number)
    assert acting == [1001, 1002, 1003, 1004]
    assert injection.waiting == injection.acting == ()


def test_the_same_fault_injected_again_waits_although_it_acts():
    injection = scheduled()
    injection.inject(OFFSET, 10)
    injection.at(11, NO_TRIAL)
    injection.inject(OFFSET, 11)
    assert (injection.acting, injection.waiting) == ((OFFSET,), (OFFSET,))
    injection.at(12, NO_TRIAL)
    assert (injection.acting, injection.waiting) == ((OFFSET, OFFSET), ())


def test_a_fault_by_hand_waits_for_its_delay():
    injection, fault = scheduled(), Fault("dropout", "force", 0.009, 0.0)
    injection.inject(fault, 50)
    assert [bool(injection.at(number, NO_TRIAL)) for number in (51, 52, 53, 54, 9_999_999)] == [False, False, True, True, True]


def test_what_was_injected_outlasts_trials_and_another_load_until_it_is_cleared():
    injection = scheduled(STUCK)
    injection.inject(OFFSET, 10)
    injection.schedule((), 4, PERIOD_NS)
    for number, tick in ((11, NO_TRIAL), (12, -444), (600, 144), (2000, NO_TRIAL)):
        (row,) = injection.at(number, tick)
        assert row[FIRST] == (11 - number) + (number if tick == NO_TRIAL else tick)  # its age goes on through the change
    injection.clear()
    assert injection.at(2001, NO_TRIAL) == ()
    assert injection.acting == injection.waiting == ()


def test_both_kinds_act_together_the_trials_first():
    injection = scheduled(STUCK)
    injection.inject(OFFSET, 10)
    assert len(injection.at(700, 100)) == 2
    assert injection.acting == (STUCK, OFFSET)


@pytest.mark.parametrize(
    ("at_s", "lasts_s", "ticks"),
    [
        (0.0, 0.0, (0, 2**31)),
        (0.45, 0.09, (100, 120)),
        (0.4501, 0.09, (101, 121)),
        (-0.45, 0.001, (-100, -99)),
        (1.0, 1e-9, (223, 224)),
    ],
)
def test_a_fault_begins_at_the_first_tick_at_or_after_its_time_and_has_at_least_one(at_s, lasts_s, ticks):
    assert ticks_of(Fault("stuck", "force", at_s, lasts_s), PERIOD_NS) == ticks


def test_what_is_drawn_is_even_over_its_range_and_another_for_every_seed_channel_and_tick():
    def draws(seed, target):
        row = fault_row(Fault("garbage", target), seed, PERIOD_NS)
        return [drawn(row, tick, 1024) for tick in range(-2000, 2000)]

    first = draws(1, "encoder_rotate")
    assert first == draws(1, "encoder_rotate")
    assert (min(first) < 10, max(first) > 1013) == (True, True)
    assert abs(sum(first) / 4000 - 511.5) < 4 * 1024 / 12**0.5 / 4000**0.5
    for other in (draws(2, "encoder_rotate"), draws(1, "encoder_out_in"), first[1:]):
        assert sum(a == b for a, b in zip(first, other, strict=False)) < 20
