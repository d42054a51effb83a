import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import butter, freqs, lsim

from hydrohil.services.controller.filtering import Filtered, filter_step, low_pass
from hydrohil.shared.compiled.kernel import compiled

DT_S = 0.0045
CUTOFF = 2.0 * math.pi * 3.0
FREE = math.inf


def run(readings, dts=None, noise_n=FREE, cutoff=CUTOFF):
    state, out = Filtered(0.0, 0.0), []
    for reading, dt_s in zip(readings, dts if dts is not None else [DT_S] * len(readings), strict=True):
        state = filter_step(state, cutoff, noise_n, float(reading), float(dt_s))
        out.append(state.force_n)
    return np.array(out)


def test_it_is_the_second_order_butterworth_of_scipy():
    readings = np.random.default_rng(1).normal(size=800) * 50.0
    system = butter(2, CUTOFF, analog=True)
    want = lsim(system, np.append(readings, readings[-1]), np.arange(801) * DT_S, interp=False)[1][1:]
    assert run(readings) == pytest.approx(want, abs=1e-9)


def test_a_jittering_interval_is_integrated_as_it_is():
    random = np.random.default_rng(2)
    readings, dts = random.normal(size=60) * 50.0, random.uniform(0.004, 0.005, 60)
    state = np.zeros(2)
    for reading, dt_s in zip(readings, dts, strict=True):

        def change(_, y, reading=reading):
            return (y[1], CUTOFF * CUTOFF * (reading - y[0]) - math.sqrt(2.0) * CUTOFF * y[1])

        state = solve_ivp(change, (0.0, dt_s), state, rtol=1e-11, atol=1e-12).y[:, -1]
    assert run(readings, dts)[-1] == pytest.approx(state[0], abs=1e-7)


@pytest.mark.parametrize("share", [0.3, 1.0, 3.0])
def test_a_sine_comes_through_as_by_the_analog_filter(share):
    times = np.arange(4000) * DT_S
    got = run(np.sin(share * CUTOFF * times))[2000:]
    gain = abs(freqs(*butter(2, CUTOFF, analog=True), [share * CUTOFF])[1][0])
    assert np.ptp(got) / 2.0 == pytest.approx(gain, rel=0.02)


def test_a_constant_force_comes_through_whole_and_at_rest():
    assert run(np.full(2000, 37.0))[-1] == pytest.approx(37.0)
    assert filter_step(Filtered(37.0, 0.0), CUTOFF, 10.0, 37.0, DT_S) == Filtered(37.0, 0.0)


def test_a_cutoff_of_zero_lets_every_reading_through():
    readings = np.random.default_rng(3).normal(size=20)
    assert run(readings, cutoff=0.0) == pytest.approx(readings, abs=0.0)


def test_inside_the_noise_the_bounded_filter_is_the_low_pass():
    readings = np.random.default_rng(4).uniform(-5.0, 5.0, 400)
    assert run(readings, noise_n=10.0) == pytest.approx(run(readings), abs=0.0)


def test_the_bounded_filter_is_never_off_the_reading_by_more_than_the_noise():
    readings = np.cumsum(np.random.default_rng(5).normal(size=2000) * 8.0)
    assert np.max(np.abs(run(readings) - readings)) > 10.0
    assert np.max(np.abs(run(readings, noise_n=10.0) - readings)) <= 10.0 + 1e-12


def test_a_change_beyond_the_noise_passes_at_once():
    readings = np.concatenate((np.zeros(50), np.full(50, 80.0), np.zeros(50)))
    got = run(readings, noise_n=10.0)
    assert got[50] == 70.0
    assert got[100] == 10.0


def test_it_quietens_noise_by_the_square_root_of_its_bandwidth():
    # second-order Butterworth: noise bandwidth pi / (2 sqrt 2) of its cutoff, against half the sampling rate
    readings = np.random.default_rng(6).normal(size=60_000)
    share = math.pi / (2.0 * math.sqrt(2.0)) * 3.0 * 2.0 * DT_S
    assert np.std(run(readings)[2000:]) == pytest.approx(math.sqrt(share), rel=0.06)


def test_compiled_agrees_in_every_bit():
    fast, fast_pass = compiled(filter_step), compiled(low_pass)
    for value in (math.nan, math.inf, -math.inf, 0.0, 1e308, -3.7, 250.0):
        for dt_s in (DT_S, 0.0, -1.0, math.nan):
            state = Filtered(12.5, -300.0)
            assert repr(low_pass(state, CUTOFF, value, dt_s)) == repr(fast_pass(state, CUTOFF, value, dt_s))
            for noise_n in (10.0, FREE):
                plain = filter_step(state, CUTOFF, noise_n, value, dt_s)
                assert repr(plain) == repr(fast(state, CUTOFF, noise_n, value, dt_s))
