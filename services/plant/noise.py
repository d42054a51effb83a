"""Noise of the gauge and jitter of the sampling, as functions of (seed, channel, tick) alone.

A counter based generator (Philox) is keyed by seed and channel and addressed by the tick, so a window of ticks is the
same whether it is drawn alone or within a longer one. The draws are made from its raw words here, not by a library's
distributions, whose streams may change between versions.
"""

import math

import numpy as np
from numpy.typing import NDArray

FORCE_CHANNEL, JITTER_CHANNEL = 1, 2
WORDS_PER_TICK = 4  # what one count of Philox' counter gives
FIRST_TICK = 2**40  # keeps the counters of negative ticks positive
SEEDS = 2**64
UNUSED_BITS = 11  # 64 bits to the 53 of a float's mantissa
SPACING = 2.0**-53


def uniforms(seed: int, channel: int, first_tick: int, count: int) -> NDArray[np.float64]:
    """Numbers in (0, 1], shape (count, 4), four of each tick."""
    key = np.array([seed % SEEDS, channel], dtype=np.uint64)
    counter = np.array([FIRST_TICK + first_tick, 0, 0, 0], dtype=np.uint64)
    words = np.random.Philox(key=key, counter=counter).random_raw(WORDS_PER_TICK * count)
    mantissas = (words >> np.uint64(UNUSED_BITS)).astype(np.float64)
    return ((mantissas + 1.0) * SPACING).reshape(count, WORDS_PER_TICK)


def force_noise_n(seed: int, first_tick: int, count: int, sigma_n: float, clip_n: float) -> NDArray[np.float64]:
    """Gaussian noise in N clipped at +-`clip_n`, one value a tick, shape (count,)  (Box and Muller)."""
    drawn = uniforms(seed, FORCE_CHANNEL, first_tick, count)
    gaussian = np.sqrt(-2.0 * np.log(drawn[:, 0])) * np.cos(2.0 * math.pi * drawn[:, 1])
    return np.clip(sigma_n * gaussian, -clip_n, clip_n)


def sample_intervals(seed: int, first_tick: int, count: int, period_substeps: int, jitter_substeps: int) -> NDArray[np.int64]:
    """Sub-steps from each tick's sample to the next: uniform in period +- jitter, shape (count,)."""
    drawn = uniforms(seed, JITTER_CHANNEL, first_tick, count)[:, 0]
    steps = np.ceil(drawn * (2 * jitter_substeps + 1)).astype(np.int64) - 1
    return period_substeps - jitter_substeps + steps
