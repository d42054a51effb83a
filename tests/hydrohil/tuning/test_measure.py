"""What is read off a trace, on signals whose numbers are known."""

import math

import numpy as np
import pytest

from hydrohil.shared.contract.messages import Mode
from hydrohil.tuning import measure
from hydrohil.tuning.patterns import pattern, slow_ramp
from tests.hydrohil.claims.test_trace import link, standing
from tests.support.tuning_scene import COUNT, GAINS, LINK

RAMP = pattern("large-ramp", LINK, GAINS)
STEP = pattern("small-step", LINK, GAINS)
LEAST = 0.5


def following(setpoint, error_rad):
    """A link that stays `error_rad` (n,) behind the set-point of a pattern of 10 s."""
    trace = standing(setpoint.duration_s)
    way = np.zeros(len(trace.t_s))
    for segment in setpoint.reference:
        share = np.clip((trace.t_s - segment.start_s) / max(segment.duration_s, 1e-9), 0.0, 1.0)
        way += segment.amount * share
    error = error_rad(trace.t_s)
    return trace._replace(q_set=link(way, 2), q=link(way - error, 2), current_a=link(100.0 * error, 2))


def ringing(growth_per_s, amplitude_counts=3.0):
    def error(t):
        since = t % 5.0
        return amplitude_counts * COUNT * np.exp(growth_per_s * since) * np.sin(2.0 * np.pi * 8.0 * t)

    return measure.ringing(following(RAMP, error), LINK, RAMP, LEAST)


def test_a_sine_of_the_error_has_its_rms_as_ripple():
    ring = ringing(0.0)
    assert ring.early == pytest.approx(3.0 / math.sqrt(2.0), rel=0.05)
    assert ring.late == pytest.approx(ring.early, rel=0.05)


def test_ringing_that_dies_away_is_distinguished_from_ringing_that_grows():
    assert measure.lasting(ringing(-1.0), LEAST) < 1.0 < measure.lasting(ringing(1.0), LEAST)


def test_ringing_below_the_least_is_none_even_if_it_grows():
    assert measure.lasting(ringing(1.0, amplitude_counts=0.02), LEAST) < 1.0


def test_the_transient_of_a_first_order_lag_is_no_ringing():
    lag = following(RAMP, lambda t: 0.02 * (1.0 - np.exp(-(t % 5.0) / 0.4)))
    assert measure.ringing(lag, LINK, RAMP, LEAST).late < LEAST


def test_the_ringing_that_counts_is_that_of_the_worse_way():
    only_back = following(RAMP, lambda t: np.where(t > 5.0, 3.0 * COUNT * np.sin(2.0 * np.pi * 8.0 * t), 0.0))
    assert measure.ringing(only_back, LINK, RAMP, LEAST).late > 1.0


def test_a_link_at_half_speed_has_half_the_set_speed():
    half = following(RAMP, lambda t: np.zeros(len(t)))
    half = half._replace(q=0.5 * half.q_set)
    assert measure.cruise_share(half, LINK, RAMP) == pytest.approx(0.5, rel=1e-6)


def test_the_current_at_constant_speed_is_meant_without_sign():
    trace = following(RAMP, lambda t: np.where(t < 5.0, 1.0, -1.0))
    assert measure.cruise_current_a(trace, LINK, RAMP) == pytest.approx(100.0)


@pytest.mark.parametrize(("turns", "counts", "counted"), [(0, 5.0, 0), (1, 5.0, 1), (4, 5.0, 4), (4, 1.9, 0)])
def test_a_link_hunts_as_often_as_it_turns_round_at_rest(turns, counts, counted):
    def error(t):
        since = np.clip(t - 3.1, 0.0, None)
        return np.where(t < 5.0, counts * COUNT * 0.5 * (1.0 - np.cos(np.pi * np.minimum(since / 0.4, turns))), 0.0)

    assert measure.hunting(following(STEP, error), LINK, STEP) == counted


@pytest.mark.parametrize("half", [0.0, 5.0])
def test_overshoot_is_the_worse_of_both_ways(half):
    def error(t):
        beyond = np.where((t > half + 1.0) & (t < half + 1.2), 4.0 * COUNT, 0.0)
        return -beyond if half == 0.0 else beyond

    assert measure.overshoot_counts(following(STEP, error), LINK, STEP) == pytest.approx(4.0, abs=0.01)


def test_breakaway_is_the_largest_current_before_the_second_count():
    setpoint = slow_ramp(LINK, 0.0, 0.01, 10.0)
    trace = following(setpoint, lambda t: 0.01 * t)  # stands
    moved = trace._replace(q=link(np.where(trace.t_s > 6.0, 2.0 * COUNT, 0.0), 2))
    assert measure.breakaway_a(moved, LINK) == pytest.approx(100.0 * 0.01 * 6.0, rel=1e-2)


def test_one_count_is_no_motion_and_a_link_that_stands_has_no_breakaway():
    setpoint = slow_ramp(LINK, 0.0, 0.01, 10.0)
    trace = following(setpoint, lambda t: 0.01 * t)
    assert math.isnan(measure.breakaway_a(trace, LINK))
    flicker = trace._replace(q=link(np.where(trace.t_s > 6.0, COUNT, 0.0), 2))
    assert math.isnan(measure.breakaway_a(flicker, LINK))


def test_a_trial_that_tripped_or_ended_early_is_not_whole():
    trace = standing(10.0)
    assert measure.whole(trace, 10.0)
    assert not measure.whole(trace, 11.0)
    tripped = trace.mode.copy()
    tripped[-1] = Mode.TRIPPED
    assert not measure.whole(trace._replace(mode=tripped), 10.0)
    assert not measure.whole(trace._replace(t_s=trace.t_s[:0], mode=trace.mode[:0]), 10.0)
