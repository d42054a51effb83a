"""What the DAQ reads of the machine: encoder counters and the force gauge, in counts."""

import math

from hydrohil.services.plant.params import MachineParams
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.machine.unimate import UNIMATE

SCALE = tuple(channel.scale for channel in UNIMATE.encoders)
OFFSET = tuple(channel.offset for channel in UNIMATE.encoders)
MASK = tuple((1 << channel.bits) - 1 for channel in UNIMATE.encoders)
N_PER_COUNT = UNIMATE.force.scale
MIN_FORCE_COUNTS, MAX_FORCE_COUNTS = UNIMATE.force.low, UNIMATE.force.high
COUNTS_LIMIT = 1e9  # beyond it, or not a number: nothing that a counter holds
ROLL_COUNT = 0  # the program reads this channel and uses it nowhere


@kernel
def encoder_count(value: float, scale: float, offset: float, mask: int) -> int:
    """Counter of an encoder: floor((value - offset) / scale), wrapped to its bits; zero for what is no number."""
    counts = (value - offset) / scale
    if not -COUNTS_LIMIT < counts < COUNTS_LIMIT:
        return 0
    return math.floor(counts) & mask


@kernel
def encoder_counts(q: tuple[float, float, float], q4_rad: float) -> tuple[int, int, int, int, int]:
    """Counters of rotate, down/up, out/in, roll and pitch."""
    return (
        encoder_count(q[0], SCALE[0], OFFSET[0], MASK[0]),
        encoder_count(q[1], SCALE[1], OFFSET[1], MASK[1]),
        encoder_count(q[2], SCALE[2], OFFSET[2], MASK[2]),
        ROLL_COUNT,
        encoder_count(q4_rad, SCALE[4], OFFSET[4], MASK[4]),
    )


@kernel
def gauge_n(machine: MachineParams, force_n: float, noise_n: float) -> float:
    """What the gauge's amplifier gets: force + bias + noise."""
    return force_n + machine.force_bias_n + noise_n


@kernel
def amplified_counts(machine: MachineParams, reading_n: float) -> int:
    """A/D counts of a reading: limited by the amplifier, floored; lowest count if not a number."""
    if reading_n < machine.force_low_n:
        reading_n = machine.force_low_n
    elif reading_n > machine.force_high_n:
        reading_n = machine.force_high_n
    counts = reading_n / N_PER_COUNT
    if not counts > MIN_FORCE_COUNTS:
        return MIN_FORCE_COUNTS
    if counts > MAX_FORCE_COUNTS:
        return MAX_FORCE_COUNTS
    return math.floor(counts)


@kernel
def gauge_counts(machine: MachineParams, force_n: float, noise_n: float) -> int:
    """A/D counts of the gauge."""
    return amplified_counts(machine, gauge_n(machine, force_n, noise_n))
