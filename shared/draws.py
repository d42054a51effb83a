"""Random numbers as functions of (seed, channel, tick) alone.

A counter based generator (Philox) is keyed by seed and channel and addressed by the tick, so a window of ticks is the
same whether it is drawn alone or within a longer one. The numbers are formed here from the generator's raw words, not by a
library's distributions, whose streams may change between versions.
"""

import numpy as np
from numpy.typing import NDArray

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
