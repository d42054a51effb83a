"""Low-pass filter on the gauge's reading, in place of the program's mean of three (thesis 9.3.1)."""

import math
from typing import NamedTuple

from hydrohil.services.controller.impedance import decay, respond
from hydrohil.shared.compiled.kernel import kernel

BUTTERWORTH = math.sqrt(0.5)  # damping ratio of the second-order low-pass whose pass band is the flattest


class Filtered(NamedTuple):
    """The filter's output and its rate of change."""

    force_n: float
    rate_n_per_s: float


@kernel
def low_pass(state: Filtered, cutoff_rad_per_s: float, reading_n: float, dt_s: float) -> Filtered:
    """y'' + sqrt(2) w y' + w^2 y = w^2 f after `dt_s` under f = `reading_n`: second-order Butterworth, -3 dB at w.

    Exact for any interval, because samples come 4 to 5 ms apart; the newest reading stands for the interval that it
    ends, as in the target model.
    """
    free = decay(cutoff_rad_per_s, BUTTERWORTH, dt_s)
    force_n, rate_n_per_s = respond(free, state.force_n, state.rate_n_per_s, reading_n)
    return Filtered(force_n, rate_n_per_s)


@kernel
def filter_step(state: Filtered, cutoff_rad_per_s: float, noise_n: float, reading_n: float, dt_s: float) -> Filtered:
    """The low-pass, kept within `noise_n` of the reading, because so near is the force; a cutoff of 0 lets everything pass.

    Inside the noise the filter is as slow as its cutoff, a change beyond the noise passes at once.
    """
    if cutoff_rad_per_s == 0.0:
        return Filtered(reading_n, 0.0)
    smooth = low_pass(state, cutoff_rad_per_s, reading_n, dt_s)
    if smooth.force_n > reading_n + noise_n:
        return Filtered(reading_n + noise_n, smooth.rate_n_per_s)
    if smooth.force_n < reading_n - noise_n:
        return Filtered(reading_n - noise_n, smooth.rate_n_per_s)
    return smooth
