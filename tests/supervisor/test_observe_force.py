"""Windows of the gauge: what noise, contact and motion may do without being taken for a fault, and what may not."""

import math

import numpy as np
import pytest

from hydrohil.services.plant.noise import force_noise_n
from hydrohil.services.supervisor.observe_force import (
    LOOSE_M_PER_S,
    SMOOTHING_S,
    ForceMemory,
    GaugeMotion,
    force_begin,
    force_step,
)
from hydrohil.shared.machine.unimate import UNIMATE

GAUGE, COUNT_M = UNIMATE.gauge, UNIMATE.motion.tip_count_m
NOISE_N, GAUGE_N_PER_M, GAUGE_NS_PER_M = GAUGE.noise_n, GAUGE.stiffness_n_per_m, GAUGE.damping_ns_per_m
DT_NS = 4_500_000
DT_S = 0.0045
NOTHING = ForceMemory(counts=0, raw_n=0.0, smooth_n=0.0, explained_n=0.0, quiet_samples=0, held_ns=0, energy_j=0.0)
REST = GaugeMotion(True, 0.0, 0.0, DT_NS, 0.0, 4.0)


def step(memory, raw_n, motion=REST, quiet_counts=1, level_n=300.0):
    return force_step(
        memory,
        GAUGE,
        motion,
        counts=math.floor(raw_n / UNIMATE.force.scale),
        raw_n=raw_n,
        tip_count_m=COUNT_M,
        quiet_counts=quiet_counts,
        level_n=level_n,
    )


def played(readings, motion=REST, memory=None, **changes):
    observed = None
    for raw_n in readings:
        follows = memory is not None
        memory, observed = step(memory or NOTHING, raw_n, motion._replace(follows=follows), **changes)
    return memory, observed


def test_the_first_reading_begins_every_window():
    memory, observed = step(
        ForceMemory(counts=7, raw_n=500.0, smooth_n=400.0, explained_n=90.0, quiet_samples=9, held_ns=99, energy_j=9.0),
        50.0,
        REST._replace(follows=False),
    )
    assert memory == ForceMemory(counts=37, raw_n=50.0, smooth_n=50.0, explained_n=50.0, quiet_samples=0, held_ns=0, energy_j=0.0)
    assert (observed.jump_n, observed.rate_n_per_s, observed.unexplained_n, observed.smooth_n) == (0.0, 0.0, 0.0, 50.0)


def test_known_noise_is_never_quiet_for_long_nor_fast_nor_a_jump_nor_unexplained():
    noise_n = 30.0 + force_noise_n(5, 0, 20_000, 5.0, NOISE_N)
    memory, longest, rate, unexplained = None, 0, 0.0, 0.0
    for raw_n in noise_n:
        counted_n = math.floor(raw_n / UNIMATE.force.scale) * UNIMATE.force.scale
        memory, observed = step(memory or NOTHING, counted_n, REST._replace(follows=memory is not None))
        longest, rate = max(longest, observed.quiet_samples), max(rate, abs(observed.rate_n_per_s))
        unexplained = max(unexplained, observed.unexplained_n)
        assert abs(observed.jump_n) <= observed.jump_limit_n
    assert longest < 16
    assert rate <= 2.0 * NOISE_N / (SMOOTHING_S + DT_S) + UNIMATE.force.scale / SMOOTHING_S
    assert unexplained <= 2.0 * NOISE_N + UNIMATE.force.scale


def test_a_reading_that_stays_is_counted_and_one_that_changes_by_two_counts_is_not():
    one, two = UNIMATE.force.scale * 40.5, UNIMATE.force.scale * 41.5
    assert played([one] * 5)[1].quiet_samples == 4
    assert played([one, two, one])[1].quiet_samples == 2
    assert played([one, two, one], quiet_counts=0)[1].quiet_samples == 0
    assert played([one, one + 2.0 * UNIMATE.force.scale])[1].quiet_samples == 0
    memory = played([one] * 5)[0]
    assert step(memory, one, REST._replace(dt_ns=1))[1].quiet_samples == 5
    assert step(memory, one, REST._replace(dt_ns=0))[1].quiet_samples == 0  # an absence is no reading


@pytest.mark.parametrize("rate", [-2000.0, 3000.0])
def test_the_rate_of_a_ramp_is_found_within_a_few_smoothing_times(rate):
    observed = played([400.0 + rate * DT_S * i for i in range(40)])[1]
    assert observed.rate_n_per_s == pytest.approx(rate, rel=1e-3)
    assert observed.smooth_n == pytest.approx(400.0 + rate * DT_S * 39 - rate * SMOOTHING_S, rel=1e-3)


def test_time_above_the_level_is_counted_while_it_lasts():
    memory, observed = played([320.0] * 11)
    assert observed.held_ns == 10 * DT_NS + DT_NS
    assert played([300.0] * 11)[1].held_ns == 0
    assert step(memory, -500.0)[1].held_ns == 0
    assert played([320.0] * 11, REST._replace(bias_n=20.0))[1].held_ns == 0


def test_work_done_on_a_spring_is_its_energy_and_comes_back():
    k, steps = 6232.0, 200
    way_m = 0.04 / steps
    memory, observed = None, None
    for i in range(steps + 1):
        motion = REST._replace(follows=memory is not None, way_m=way_m if memory else 0.0)
        memory, observed = step(memory or NOTHING, k * way_m * i, motion)
    assert observed.energy_j == pytest.approx(0.5 * k * 0.04 * 0.04, rel=0.05)  # the smooth force lags a little
    for i in range(steps, -1, -1):
        memory, observed = step(memory, k * way_m * i, REST._replace(way_m=-way_m))
    assert observed.energy_j == 0.0


def test_what_touches_nothing_takes_no_energy_and_a_nan_is_not_remembered():
    assert played([NOISE_N] * 5, REST._replace(way_m=1.0))[1].energy_j == 0.0
    memory, observed = played([100.0] * 5, REST._replace(way_m=0.01))
    assert observed.energy_j == pytest.approx(4 * 1.0 + 1.0 * 1.0, rel=0.3)
    memory, observed = step(memory, 100.0, REST._replace(way_m=math.nan))
    assert math.isnan(observed.energy_j)
    memory, observed = step(memory, 100.0, REST._replace(way_m=math.nan))
    assert observed.energy_j == 0.0


def test_the_jump_that_is_borne_is_noise_and_the_gauges_own_spring_and_damper_at_this_speed():
    at_rest_n = 2.0 * NOISE_N + (GAUGE_N_PER_M * DT_S + GAUGE_NS_PER_M) * COUNT_M / (SMOOTHING_S + DT_S)
    _, observed = played([50.0, 50.0 + at_rest_n])
    assert (observed.jump_n, observed.jump_limit_n) == (pytest.approx(at_rest_n), pytest.approx(at_rest_n))
    for speed in (0.1, -0.1):
        moving = played([50.0], REST._replace(speed_m_per_s=speed))[1]
        assert moving.jump_limit_n - at_rest_n == pytest.approx(0.1 * (GAUGE_N_PER_M * DT_S + GAUGE_NS_PER_M))


def test_a_rise_without_a_way_is_unexplained_and_one_with_it_is_not():
    _, observed = played([50.0 + 2.0 * i for i in range(60)])
    assert observed.unexplained_n == pytest.approx(118.0)
    assert observed.unexplained_limit_n == pytest.approx(2.0 * NOISE_N + GAUGE_N_PER_M * COUNT_M + GAUGE_NS_PER_M * LOOSE_M_PER_S)
    assert observed.unexplained_n > observed.unexplained_limit_n
    stiff = REST._replace(way_m=2.0 / GAUGE_N_PER_M)
    assert played([50.0 + 2.0 * i for i in range(60)], stiff)[1].unexplained_n == pytest.approx(0.0, abs=1e-9)
    away = REST._replace(way_m=-0.01)
    assert played([50.0 + 2.0 * i for i in range(60)], away)[1].unexplained_n == pytest.approx(118.0)


def test_what_a_crate_takes_off_the_reading_while_the_tool_moves_is_given_back():
    memory = played([100.0], REST._replace(speed_m_per_s=-0.1))[0]
    memory = step(memory, 100.0, REST._replace(speed_m_per_s=-0.1))[0]
    assert memory.explained_n == pytest.approx(100.0)  # a reading before binds; the allowance of now does not raise it
    faster = step(
        ForceMemory(counts=0, raw_n=300.0, smooth_n=300.0, explained_n=300.0, quiet_samples=0, held_ns=0, energy_j=0.0),
        100.0,
        REST._replace(speed_m_per_s=0.1),
    )[0]
    assert faster.explained_n == pytest.approx(100.0 + 0.1 * GAUGE_NS_PER_M)


def test_a_wall_of_any_stiffness_met_at_any_speed_is_explained():
    for speed in (0.02, 0.1, 0.3):
        for stiffness in (7208.0, 53150.0, 1e6):
            k = 1.0 / (1.0 / stiffness + 1.0 / GAUGE_N_PER_M)
            way = np.floor(np.arange(40) * speed * DT_S / COUNT_M) * COUNT_M
            memory = None
            for i in range(40):
                motion = GaugeMotion(memory is not None, way[i] - way[i - 1] if memory else 0.0, speed, DT_NS, 0.0, 4.0)
                memory, observed = step(memory or NOTHING, k * speed * DT_S * max(0, i - 10), motion)
                assert observed.unexplained_n <= observed.unexplained_limit_n
                assert abs(observed.jump_n) <= observed.jump_limit_n


def test_force_is_observed_raw_and_without_its_bias():
    observed = step(NOTHING, 50.0, REST._replace(follows=False, bias_n=20.0))[1]
    assert (observed.raw_n, observed.tared_n, observed.smooth_n, observed.bias_n, observed.bias_spread_n) == (
        50.0,
        30.0,
        30.0,
        20.0,
        4.0,
    )


def test_work_taken_back_beyond_what_was_given_counts_for_nothing():
    memory, observed = played([100.0] * 3, REST._replace(way_m=-1.0))
    assert (memory.energy_j, observed.energy_j) == (0.0, 0.0)
    assert step(memory, 100.0, REST._replace(way_m=0.002))[1].energy_j == pytest.approx(0.2)


def test_every_window_begins_at_the_first_force():
    assert force_begin(9, 12.5) == ForceMemory(
        counts=9, raw_n=12.5, smooth_n=12.5, explained_n=12.5, quiet_samples=0, held_ns=0, energy_j=0.0
    )
    memory, observed = step(
        ForceMemory(counts=9, raw_n=9.0, smooth_n=9.0, explained_n=9.0, quiet_samples=9, held_ns=9, energy_j=9.0),
        400.0,
        REST._replace(follows=False, bias_n=0.0),
    )
    assert (observed.held_ns, observed.energy_j, memory.quiet_samples) == (DT_NS, 0.0, 0)
    assert step(memory, 400.0, REST._replace(way_m=0.01))[1].energy_j == pytest.approx(4.0)
    assert (
        step(
            ForceMemory(counts=0, raw_n=290.0, smooth_n=290.0, explained_n=290.0, quiet_samples=0, held_ns=5, energy_j=0.0), 290.0
        )[1].held_ns
        == 0
    )
