import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.contract.topics import BY_KEY
from hydrohil.shared.transport.impairment import Active, Leg, Route, draw, flip, on_path, outcome, paths_of, route_of

PERIOD = 90
PERIOD_NS = 4_500_000
COMMAND, SAMPLE = "controller>plant", "plant>controller"


def route(*faults, seed=1):
    """A command's way under these faults, from 0 s for ever."""
    acting = {path: on_path(path, faults, PERIOD_NS) for path in (COMMAND, SAMPLE)}
    return route_of(BY_KEY["controller/command"], "plant", seed, PERIOD, acting)


def share(way, what, ticks=4000):
    return sum(what(outcome(way, tick)) for tick in range(ticks)) / ticks


def test_without_a_fault_everything_comes_at_once():
    assert all(outcome(route(), tick).taken and outcome(route(), tick).delay == 0 for tick in range(-8, 100))


def test_a_burst_takes_its_number_of_messages_from_its_first_tick_on():
    way = route(Fault("burst", COMMAND, 0.009, value=3.0))
    assert [tick for tick in range(20) if outcome(way, tick).lost] == [2, 3, 4]


def test_a_fault_begins_at_the_first_tick_at_or_after_its_instant_and_ends_before_its_end():
    way = route(Fault("partition", COMMAND, 0.0091, lasts_s=0.009))
    assert [tick for tick in range(20) if outcome(way, tick).lost] == [3, 4]


def test_a_cut_acts_both_ways_where_there_are_two():
    assert paths_of(Fault("partition", "plant-controller")) == (SAMPLE, COMMAND)
    assert paths_of(Fault("partition", "controller-supervisor")) == ("controller>supervisor",)
    assert paths_of(Fault("loss", COMMAND)) == (COMMAND,)


@pytest.mark.parametrize("probability", [0.01, 0.2, 0.5])
def test_loss_takes_its_share(probability):
    sigma = math.sqrt(probability * (1.0 - probability) / 4000)
    way = route(Fault("loss", COMMAND, value=probability))
    assert abs(share(way, lambda found: found.lost) - probability) < 4.0 * sigma


def test_certain_and_impossible_faults_are_exactly_that():
    assert share(route(Fault("loss", COMMAND, value=1.0)), lambda found: found.lost, 300) == 1.0
    assert share(route(Fault("loss", COMMAND, value=0.0)), lambda found: found.lost, 300) == 0.0
    assert share(route(Fault("duplicate", COMMAND, value=1.0)), lambda found: found.copies, 300) == 2.0


def test_another_seed_takes_others_and_the_same_seed_the_same():
    def lost(seed):
        return [tick for tick in range(300) if outcome(route(Fault("loss", COMMAND, value=0.2), seed=seed), tick).lost]

    assert lost(1) == lost(1) != lost(2)


def test_a_constant_delay_keeps_the_order():
    way = route(Fault("delay", COMMAND, value=50.0))
    assert all(outcome(way, tick).taken and outcome(way, tick).delay == 1000 for tick in range(50))


def test_delays_of_question_and_answer_add_up():
    way = route(Fault("delay", SAMPLE, value=3.0), Fault("delay", COMMAND, value=1.05))
    assert (outcome(way, 7).delay, outcome(way, 7).own) == (81, 21)


def test_what_is_sent_when_a_delay_ends_overtakes_what_is_still_under_way():
    way = route(Fault("delay", COMMAND, lasts_s=0.045, value=9.0))
    assert [tick for tick in range(20) if outcome(way, tick).overtaken] == [
        9
    ]  # that of tick 8 comes with that of tick 10, and is older


def test_jitter_stays_within_its_bound_and_takes_every_sub_step():
    delays = {outcome(route(Fault("jitter", COMMAND, value=0.2)), tick).delay for tick in range(300)}
    assert delays == {0, 1, 2, 3, 4}


def test_reordering_lets_the_successor_pass_so_that_every_other_message_is_old():
    way = route(Fault("reorder", COMMAND, lasts_s=0.0045, value=1.0))
    assert outcome(way, 0).overtaken and outcome(way, 1).taken


def test_a_message_whose_successor_is_lost_is_late_and_not_old():
    way = route(Fault("reorder", COMMAND, lasts_s=0.0045, value=1.0), Fault("burst", COMMAND, 0.0045, value=1.0))
    assert outcome(way, 0).taken and outcome(way, 0).delay == PERIOD


@given(st.binary(min_size=1, max_size=200), st.floats(0.0, 1.0, exclude_max=True))
def test_corruption_flips_exactly_one_bit(frame, place):
    turned = flip(frame, place)
    assert sum((a ^ b).bit_count() for a, b in zip(frame, turned, strict=True)) == 1


@given(st.integers(0, 2**64 - 1), st.integers(-10_000, 10_000_000))
def test_draws_lie_between_0_and_1(seed, tick):
    assert 0.0 <= draw(seed, Leg(COMMAND, "controller/command", ()), Active("loss", 0, 9, 0.5), tick) < 1.0


@settings(deadline=None)
@given(
    st.lists(st.tuples(st.sampled_from(["delay", "jitter", "reorder", "loss", "corrupt"]), st.floats(0.0, 1.0)), max_size=4),
    st.lists(st.tuples(st.sampled_from(["delay", "jitter", "reorder", "loss"]), st.floats(0.0, 1.0)), max_size=4),
    st.integers(0, 1000),
)
def test_what_is_taken_comes_in_the_order_in_which_it_was_sent(own, before, seed):
    def active(rows):
        return tuple(Active(kind, 5, 40, value * 400 if kind in ("delay", "jitter") else value) for kind, value in rows)

    legs = (Leg(SAMPLE, "plant/sample", active(before)), Leg(COMMAND, "controller/command", active(own)))
    way = Route(seed, PERIOD, legs)
    upstream = way._replace(legs=legs[:1])
    coming = [
        tick * PERIOD + outcome(way, tick).delay
        for tick in range(60)
        if outcome(upstream, tick).taken and outcome(way, tick).taken
    ]
    assert coming == sorted(coming)
