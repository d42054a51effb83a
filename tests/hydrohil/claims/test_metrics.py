import math
from typing import get_args

import numpy as np
import pytest

from hydrohil.claims import metrics
from hydrohil.claims.metrics import METRICS, MetricName
from hydrohil.claims.signals import COUNT_Q, alternations, moves
from tests.hydrohil.claims.test_trace import link, standing

COUNT = COUNT_Q[1]


def sine(duration_s, amplitude=1.0, hz=1.0, share=1.0, lag_rad=0.0):
    """Link 2 follows a sine set-point with `share` of its amplitude, `lag_rad` late."""
    trace = standing(duration_s)
    phase = 2.0 * np.pi * hz * trace.t_s
    return trace._replace(
        q_set=link(amplitude * np.sin(phase), 2),
        q=link(amplitude * share * np.sin(phase - lag_rad), 2),
        qd_set=link(amplitude * 2.0 * np.pi * hz * np.cos(phase), 2),
    )


def force(values, setpoint=0.0):
    trace = standing((len(values) - 1) * 4.5e-3)
    return trace._replace(force_n=np.asarray(values, dtype=float), force_set_n=np.zeros(len(values)) + setpoint)


def test_the_table_holds_every_metric_that_a_claim_can_name():
    assert set(METRICS) == set(get_args(MetricName))
    for name, metric in METRICS.items():
        assert metric.of is getattr(metrics, name)
        assert metric.of.__doc__


@pytest.mark.parametrize("lag_rad", [0.1, 0.7, math.pi])
def test_a_late_sine_has_the_rms_error_of_its_lag(lag_rad):
    trace = sine(9.0, amplitude=3.0, lag_rad=lag_rad)
    assert metrics.rms_error(trace, "q2") == pytest.approx(3.0 * math.sqrt(2.0) * math.sin(lag_rad / 2.0), rel=1e-3)
    assert metrics.max_error(trace, "q2") == pytest.approx(6.0 * math.sin(lag_rad / 2.0), rel=1e-3)
    assert metrics.relative_error(trace, "q2") == pytest.approx(2.0 * math.sin(lag_rad / 2.0), rel=1e-3)


def test_standing_still_is_a_relative_error_of_one():
    assert metrics.relative_error(sine(9.0, share=0.0), "q2") == pytest.approx(1.0, rel=1e-3)


def test_a_constant_set_point_determines_no_relative_error():
    assert math.isnan(metrics.relative_error(standing(1.0), "q2"))
    assert math.isnan(metrics.peak_to_peak_ratio(standing(1.0), "q2"))


def test_half_the_amplitude_is_a_peak_to_peak_ratio_of_a_half():
    trace = sine(5.0, amplitude=0.4, share=0.5)
    assert metrics.peak_to_peak_ratio(trace, "q2") == pytest.approx(0.5, rel=1e-9)
    assert metrics.peak_to_peak(trace, "q2") == pytest.approx(0.4, rel=1e-3)
    assert metrics.peak_to_peak_counts(trace, "q2") == pytest.approx(0.4 / COUNT, rel=1e-3)


def test_steady_errors_are_relative_to_set_point_and_to_count_width():
    assert metrics.steady_error(force(np.full(100, 94.0), 100.0), "force") == pytest.approx(0.06)
    assert metrics.steady_error(force(np.full(100, 106.0), 100.0), "force") == pytest.approx(0.06)
    assert math.isnan(metrics.steady_error(force(np.full(100, 94.0), 0.0), "force"))
    trace = standing(1.0)
    assert metrics.steady_error_counts(trace._replace(q=trace.q + 2.0 * COUNT), "q2") == pytest.approx(2.0)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_overshoot_counts_in_the_direction_of_the_move(direction):
    trace = standing(2.0)
    setpoint = np.where(trace.t_s < 1.0, 0.0, 1.0)
    response = setpoint * (1.0 + 0.25 * np.exp(-np.maximum(trace.t_s - 1.0, 0.0)))
    trace = trace._replace(q_set=link(direction * setpoint, 2), q=link(direction * response, 2))
    assert metrics.overshoot(trace, "q2") == pytest.approx(0.25, rel=1e-2)
    short = trace._replace(q=trace.q * 0.7)
    assert metrics.overshoot(short, "q2") == pytest.approx(1.25 * 0.7 - 1.0, rel=1e-1)
    assert math.isnan(metrics.overshoot(standing(1.0), "q2"))


def ramps(delay_s, second_delay_s):
    """Up from 1 s, down from 4 s, each answered late."""
    trace = standing(8.0)
    up, down = np.clip(trace.t_s - 1.0, 0.0, 2.0), np.clip(trace.t_s - 4.0, 0.0, 2.0)
    late_up = np.where(trace.t_s > 1.0 + delay_s, up, 0.0)
    late_down = np.where(trace.t_s > 4.0 + second_delay_s, down, 0.0)
    return trace._replace(q_set=link(up - down, 2), q=link(late_up - late_down, 2))


def test_delays_run_from_the_start_of_each_move():
    trace = ramps(0.5, 1.2)
    assert metrics.first_delay_s(trace, "q2") == pytest.approx(0.5, abs=0.01)
    assert metrics.longest_delay_s(trace, "q2") == pytest.approx(1.2, abs=0.01)
    assert metrics.first_motion_s(trace, "q2") == pytest.approx(1.5, abs=0.01)


def test_a_link_that_never_moves_is_late_until_the_end():
    trace = ramps(0.5, 1.2)
    stuck = trace._replace(q=np.zeros_like(trace.q))
    assert metrics.first_delay_s(stuck, "q2") == pytest.approx(3.0, abs=0.01)
    assert math.isnan(metrics.first_motion_s(stuck, "q2"))
    assert math.isnan(metrics.first_delay_s(standing(1.0), "q2"))


def test_one_count_is_no_motion_and_two_are():
    trace = standing(1.0)
    setpoint = link(trace.t_s, 2)
    for counts, moved in ((1.0, False), (2.0, True)):
        response = trace._replace(q_set=setpoint, q=link(np.where(trace.t_s > 0.5, counts * COUNT, 0.0), 2))
        assert (metrics.first_delay_s(response, "q2") < 0.6) is moved


def test_error_signals_of_a_stuck_link_are_those_of_the_ramp():
    trace = standing(2.0)
    trace = trace._replace(q_set=link(0.25 * trace.t_s, 2), qd_set=link(np.full(len(trace.t_s), 0.25), 2))
    assert metrics.error_rate_to_error(trace, "q2") == pytest.approx(0.25 / 0.5, rel=1e-2)
    assert metrics.error_integral_to_error(trace, "q2") == pytest.approx(0.5 / 0.5, rel=1e-2)


def test_the_final_change_has_a_sign_and_is_a_mean_over_the_tail():
    trace = standing(10.0)
    trace = trace._replace(x_m=link(0.5 - 0.2 * (1.0 - np.exp(-3.0 * trace.t_s)), 3))
    assert metrics.final_change(trace, "z") == pytest.approx(-0.2, abs=1e-6)


@pytest.mark.parametrize("period_s", [1.0, 3.3, 4.7])
def test_the_period_of_a_dying_oscillation_is_found(period_s):
    trace = standing(25.0)
    swing = 0.2 * (1.0 - np.exp(-0.5 * trace.t_s) * np.cos(2.0 * np.pi / period_s * trace.t_s))
    assert metrics.period_s(trace._replace(x_m=link(swing, 3)), "z") == pytest.approx(period_s, rel=5e-3)


def test_what_does_not_oscillate_has_no_period():
    trace = standing(10.0)
    assert math.isnan(metrics.period_s(trace._replace(x_m=link(1.0 - np.exp(-trace.t_s), 3)), "z"))
    assert math.isnan(metrics.period_s(trace, "z"))


def test_settling_ends_at_a_fifth_of_the_final_value():
    trace = standing(50.0)
    decaying = 100.0 * (1.0 + np.exp(-trace.t_s / 2.0))
    assert metrics.settling_time_s(trace._replace(force_n=decaying), "force") == pytest.approx(2.0 * math.log(5.0), abs=0.01)
    assert metrics.settling_time_s(trace._replace(force_n=np.full(len(trace.t_s), 9.0)), "force") == 0.0


def test_levels_are_those_of_a_biased_sine():
    values = 150.0 + 100.0 * np.sin(2.0 * np.pi * np.arange(2001) / 2000.0)
    assert metrics.mean(force(values), "force") == pytest.approx(150.0, rel=1e-3)
    assert metrics.maximum(force(values), "force") == pytest.approx(250.0)
    assert metrics.minimum(force(values), "force") == pytest.approx(50.0)


def test_deviation_and_lag_are_against_the_nominal_trajectory_not_the_set_point():
    trace = standing(1.0)
    trace = trace._replace(x_nominal_m=link(trace.t_s, 1), x_m=link(trace.t_s - 0.03, 1), x_set_m=link(trace.t_s - 0.03, 1))
    assert metrics.mean_lag(trace, "x") == pytest.approx(0.03)
    assert metrics.max_deviation(trace, "x") == pytest.approx(0.03)


def test_retreat_is_the_largest_way_back():
    trace = standing(3.0)
    there_and_back = np.interp(trace.t_s, [0.0, 1.0, 1.5, 3.0], [0.0, 0.10, 0.08, 0.30])
    assert metrics.retreat(trace._replace(x_m=link(there_and_back, 1)), "x") == pytest.approx(0.02, abs=1e-3)
    assert metrics.retreat(trace._replace(x_m=link(trace.t_s, 1)), "x") == 0.0


def test_spikes_are_counted_once_each_whatever_the_noise():
    level = np.full(1000, 100.0)
    for at in (100, 300, 500):
        level[at : at + 50] = 150.0 + 29.0 * (-1.0) ** np.arange(50)
        level[at + 60 : at + 70] = 99.0
    assert metrics.spikes(force(level), "force") == 3.0
    assert metrics.spikes(force(np.full(1000, 100.0)), "force") == 0.0
    assert math.isnan(metrics.spikes(force(np.full(1000, 19.0)), "force"))


def test_contact_is_force_beyond_the_noise():
    values = np.array([0.0, 10.0, 19.9, 20.1, 15.0, 25.0, -0.1, 21.0, 0.0])
    assert metrics.contacts(force(values), "force") == 2.0
    assert metrics.contacts(force(np.full(5, 30.0)), "force") == 1.0
    assert metrics.contacts(force(np.full(5, 20.0)), "force") == 0.0


@pytest.mark.parametrize("true_n", [5.0, 10.0, 15.0, 50.0])
def test_noise_alone_neither_makes_nor_breaks_contact(true_n):
    noise_n = np.random.default_rng(2).uniform(-10.0, 10.0, 2000)
    assert metrics.contacts(force(true_n + noise_n), "force") == (1.0 if true_n > 10.0 else 0.0)


def test_a_reversal_of_the_control_crosses_the_whole_overlap():
    trace = standing(1.0)
    current = 0.0361 * np.sign(np.sin(2.0 * np.pi * 5.0 * trace.t_s + 0.1))
    assert metrics.control_reversals(trace._replace(current_a=link(current, 2)), "q2") == 10.0
    assert metrics.control_reversals(trace._replace(current_a=link(current * 0.99, 2)), "q2") == 0.0


def test_control_levels_are_those_of_a_sine():
    trace = standing(9.0)
    current = 0.2 * np.sin(2.0 * np.pi * trace.t_s)
    trace = trace._replace(current_a=link(current, 2))
    assert metrics.control_rms(trace, "q2") == pytest.approx(0.2 / math.sqrt(2.0), rel=1e-3)
    assert metrics.control_peak(trace, "q2") == pytest.approx(0.2, rel=1e-4)


def test_a_control_that_jumps_by_a_step_at_every_sample_is_as_noisy_as_the_step():
    trace = standing(1.0)
    jumps = 0.01 * (np.arange(len(trace.t_s)) % 2)
    assert metrics.control_noise(trace._replace(current_a=link(jumps, 2)), "q2") == pytest.approx(0.01)
    assert metrics.control_noise(trace._replace(current_a=link(jumps * 0.0 + 0.3, 2)), "q2") == 0.0


@pytest.mark.parametrize("braking_share", [0.5, 1.0, 2.0])
def test_a_scalloped_control_is_weaker_while_the_set_point_brakes(braking_share):
    trace = sine(9.0)
    speed = trace.qd_set[:, 1]
    braking = speed * np.gradient(speed, trace.t_s) < 0.0
    current = link(speed * np.where(braking, braking_share, 1.0), 2)
    assert metrics.braking_control_ratio(trace._replace(current_a=current), "q2") == pytest.approx(braking_share, rel=1e-2)


def test_the_upward_error_is_judged_above_two_hundred_newtons_only():
    setpoint = 150.0 + 100.0 * np.sin(2.0 * np.pi * np.arange(4001) / 2000.0)
    falling = np.gradient(setpoint) < 0.0
    wrong = np.where(setpoint > 200.0, np.where(falling, 30.0, 15.0), np.where(falling, 1.0, 99.0))
    assert metrics.upward_error_ratio(force(setpoint - wrong, setpoint), "force") == pytest.approx(2.0, rel=1e-2)
    assert math.isnan(metrics.upward_error_ratio(force(np.full(100, 100.0), 100.0), "force"))


def test_alternations_ignore_what_lies_between():
    values = np.array([0.0, 2.0, 0.5, 2.0, -0.5, -2.0, 0.0, 2.0])
    assert alternations(values, -1.0, 1.0).tolist() == [5, 7]


def test_a_reversal_without_rest_starts_a_new_move():
    assert moves(np.array([0.0, 0.0, 1.0, 2.0, 1.0, 1.0, 2.0])) == [(1, 3, 1.0), (3, 5, -1.0), (5, 7, 1.0)]


def test_the_cycle_ratio_is_a_mean_over_full_cycles_of_a_falling_sine():
    trace = standing(20.0)
    falling = (1.0 - trace.t_s / 25.0) * np.sin(2.0 * np.pi * trace.t_s)
    late = (1.0 - trace.t_s / 25.0) * np.sin(2.0 * np.pi * (trace.t_s - 0.06))
    trace = trace._replace(q_set=link(falling, 2), q=link(0.8 * late, 2))
    assert metrics.cycle_ratio(trace, "q2") == pytest.approx(0.8, rel=1e-2)
    first_alone = trace._replace(q=trace.q * (trace.t_s < 1.25)[:, None])
    assert metrics.cycle_ratio(first_alone, "q2") < 0.1
    assert metrics.peak_to_peak_ratio(first_alone, "q2") > 0.7


def test_without_a_full_cycle_there_is_no_cycle_ratio():
    assert math.isnan(metrics.cycle_ratio(sine(1.2), "q2"))
    assert metrics.cycle_ratio(sine(1.3), "q2") == pytest.approx(1.0)
    assert math.isnan(metrics.cycle_ratio(standing(1.0), "q2"))


def test_a_swing_is_wider_than_the_overlap_but_need_not_change_sides():
    trace = standing(2.0)
    pulses = -0.09 + 0.5 * 0.0361 * np.sign(np.sin(2.0 * np.pi * 5.0 * trace.t_s + 0.1))
    assert metrics.control_swings(trace._replace(current_a=link(pulses, 2)), "q2") == 20.0
    assert metrics.control_reversals(trace._replace(current_a=link(pulses, 2)), "q2") == 0.0
    narrow = -0.09 + 0.99 * (pulses + 0.09)
    assert metrics.control_swings(trace._replace(current_a=link(narrow, 2)), "q2") == 0.0
    slow_ramp = link(np.linspace(0.0, 0.3, len(trace.t_s)), 2)
    assert metrics.control_swings(trace._replace(current_a=slow_ramp), "q2") == 1.0


def test_upward_swings_are_those_of_the_control_while_the_force_is_lowered():
    trace = standing(4.0)
    rising = trace.t_s % 2.0 > 1.0
    force_set = np.abs((trace.t_s + 1.0) % 2.0 - 1.0) * 100.0  # up for a second, down for a second, twice
    rate = np.where(rising, 5.0, 2.0)
    current = -0.09 + 0.05 * np.sign(np.sin(2.0 * np.pi * rate * trace.t_s + 0.1))
    swinging = trace._replace(current_a=link(current, 2), force_set_n=force_set)
    assert metrics.upward_swing_ratio(swinging, "q2") == pytest.approx(2.5, rel=0.2)
    assert math.isnan(metrics.upward_swing_ratio(trace, "q2"))


def test_ringing_after_a_spike_belongs_to_it():
    for spacing, count in ((60, 1.0), (120, 2.0)):  # 0.27 s and 0.54 s
        level = np.full(2000, 100.0)
        level[100:110], level[100 + spacing : 110 + spacing] = 150.0, 150.0
        level[50], level[90 + spacing] = 99.0, 99.0
        assert metrics.spikes(force(level), "force") == count


def test_what_the_impedance_adds_is_distinguished_from_how_well_it_is_followed():
    trace = standing(1.0)
    trace = trace._replace(x_set_m=link(np.full(len(trace.t_s), 0.02), 3), x_m=link(np.full(len(trace.t_s), -0.01), 3))
    assert metrics.max_modification(trace, "z") == pytest.approx(0.02)
    assert metrics.max_deviation(trace, "z") == pytest.approx(0.01)


def test_the_departure_is_what_remains_after_the_last_contact():
    trace = standing(10.0)
    trace = trace._replace(
        force_n=np.where((trace.t_s > 2.0) & (trace.t_s < 5.0), 50.0, 9.9),
        x_m=link(0.06 * np.exp(-np.maximum(trace.t_s - 4.0, 0.0)), 3),
    )
    assert metrics.departure(trace, "z") == pytest.approx(0.06 * math.exp(-1.0), rel=2e-2)
    assert math.isnan(metrics.departure(trace._replace(force_n=np.full(len(trace.t_s), 20.0)), "z"))
    assert math.isnan(metrics.departure(trace._replace(force_n=np.full(len(trace.t_s), 50.0)), "z"))
