"""Noise of the gauge and jitter of the sampling, as functions of (seed, tick) alone."""

import math

import numpy as np
from numpy.typing import NDArray

from hydrohil.shared.draws import uniforms

FORCE_CHANNEL, JITTER_CHANNEL = 1, 2


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
