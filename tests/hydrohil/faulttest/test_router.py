"""A fault that silences the plant, judged by its last cut and the samples around the silence."""

import math

import pytest

from hydrohil.faulttest.observer import Observation
from hydrohil.faulttest.router import Cut, cut_of, judged_by_cut
from hydrohil.shared.contract.messages import GateState
from tests.hydrohil.faulttest.test_observer import FAULT_NS, PERIOD_NS, observed, sample

WAY_NS = 300_000  # of a sample to the observer
BOUND_NS = 5 * PERIOD_NS
BOUND_S = BOUND_NS / 1e9


def silence(old_ns: int = 0) -> Observation:
    """Current until the fault, nothing, then zero current from sample 60 on; two old samples come `old_ns` late."""
    moving = observed(0).samples[:30]
    old = [sample(i, (2048, 2300, 2048), GateState.OPEN, late_ns=old_ns) for i in (0, 1) if old_ns]
    return Observation(moving + old + [sample(i) for i in range(60, 100)], [], [], [], [])


def cut(after_ns: int, overrun_ns: int = 0) -> Cut:
    """So long after the fault by the clock, of which the plant stood still for a part."""
    return Cut(FAULT_NS + after_ns - overrun_ns - WAY_NS, FAULT_NS + after_ns)


@pytest.mark.parametrize("periods", [1, 4])
def test_the_reaction_is_from_the_fault_to_the_cut_and_not_to_the_first_message_of_it(periods: int):
    trial = judged_by_cut(silence(), FAULT_NS, cut(periods * PERIOD_NS), BOUND_S)
    assert trial.held, trial.words
    assert trial.reaction_s == pytest.approx(periods * PERIOD_NS / 1e9)
    assert trial.stalled_s == 0.0


def test_a_cut_on_the_bound_is_in_time_and_one_just_past_it_is_not():
    assert judged_by_cut(silence(), FAULT_NS, cut(BOUND_NS), BOUND_S).held
    late = judged_by_cut(silence(), FAULT_NS, cut(BOUND_NS + 1000), BOUND_S)
    assert not late.held and "too late" in late.words


def test_a_second_cut_long_after_the_first_is_a_late_one():
    assert not judged_by_cut(silence(), FAULT_NS, cut(50 * PERIOD_NS), BOUND_S).held


@pytest.mark.parametrize(("overrun_ns", "held"), [(30_000_000, True), (29_000_000, False)])
def test_what_the_plant_overrun_is_named_and_taken_off_and_no_more(overrun_ns: int, held: bool):
    trial = judged_by_cut(silence(), FAULT_NS, cut(BOUND_NS + 30_000_000 - 1000, overrun_ns), BOUND_S)
    assert trial.stalled_s == pytest.approx(overrun_ns / 1e9)
    assert trial.held == held


def test_samples_from_before_the_cut_that_a_thawed_router_still_delivers_are_no_resumption():
    trial = judged_by_cut(silence(old_ns=300_000_000), FAULT_NS, cut(4 * PERIOD_NS), BOUND_S)
    assert trial.held, trial.words


def test_one_sample_with_current_after_the_cut_is_a_resumption():
    found = silence()
    found.samples.append(sample(200, (2048, 2100, 2048), GateState.OPEN))
    trial = judged_by_cut(found, FAULT_NS, cut(PERIOD_NS), BOUND_S)
    assert not trial.held and "1 of them with current" in trial.words


@pytest.mark.parametrize("when", [Cut(0, 0), cut(-1), cut(1000 * PERIOD_NS)])
def test_without_a_cut_after_the_fault_and_a_sample_after_it_nothing_has_held(when: Cut):
    trial = judged_by_cut(silence(), FAULT_NS, when, BOUND_S)
    assert not trial.held and math.isnan(trial.reaction_s)


def test_the_cut_is_read_from_the_plants_status():
    assert cut_of({"last_cut_ns": 1, "last_cut_clock_ns": 2}) == Cut(1, 2)
