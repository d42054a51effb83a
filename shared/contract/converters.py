"""Counts to physical units and back: the converters of the thesis' program (Appendix F, `out_d_to_a`, `get_a_to_d`)."""

from typing import NamedTuple

from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import Channel
from hydrohil.shared.units import A_PER_MA, RAD_PER_DEG

COUNTS_PER_A = 2048.0 / (360.0 * A_PER_MA)  # scale of the program's u, from 7e4/rtd counts/deg = 215 mA/deg
REDUCTION_NUMERATOR, REDUCTION_DENOMINATOR = 3, 5  # "reduce response for amateur operator"
A_PER_CODE = 600.0 * A_PER_MA / 2048.0  # full scale of the converter
ZERO_CODE = 2048
MIN_CODE, MAX_CODE = 820, 3276  # what is left of 12 bits after the reduction
MAX_COUNTS, MIN_COUNTS = 2047, -2048

N_PER_FORCE_COUNT = 20.0 / 66.0 * 9.8 / 2.2  # the program's own scale; 4.4482 N/lb would give 1.348
MIN_FORCE_COUNTS, MAX_FORCE_COUNTS = -2048, 2047

UNIMATE_ENCODERS = (
    Channel("rotate", "rad", 0.0281778 * RAD_PER_DEG, -113.5848 * RAD_PER_DEG, 13, 0, 8191),
    Channel("down_up", "rad", -0.0284006 * RAD_PER_DEG, 27.59 * RAD_PER_DEG, 11, 0, 2047),
    Channel("out_in", "m", 0.00105, -0.0052, 10, 0, 1023),
    Channel("roll", "count", 1.0, 0.0, 10, 0, 1023),  # the program reads it and uses it nowhere
    Channel("pitch", "rad", -0.113475 * RAD_PER_DEG, 3.797 * RAD_PER_DEG, 11, 0, 2047),
)
UNIMATE_FORCE = Channel("force", "N", N_PER_FORCE_COUNT, 0.0, 12, MIN_FORCE_COUNTS, MAX_FORCE_COUNTS)
UNIMATE_CONVERTERS = tuple(
    Channel(name, "A", A_PER_CODE, -ZERO_CODE * A_PER_CODE, 12, MIN_CODE, MAX_CODE) for name in ("rotate", "down_up", "out_in")
)


class Calibration(NamedTuple):
    """Scale and offset of the channels that kinematics needs: rotate, down/up, out/in, pitch; and of the gauge."""

    scale: tuple[float, float, float, float]
    offset: tuple[float, float, float, float]
    force_n_per_count: float


def calibration(encoders: tuple[Channel, ...], force: Channel) -> Calibration:
    """The calibration that a plant's channel tables state."""
    rotate, down_up, out_in, _, pitch = encoders
    used = (rotate, down_up, out_in, pitch)
    return Calibration(
        (used[0].scale, used[1].scale, used[2].scale, used[3].scale),
        (used[0].offset, used[1].offset, used[2].offset, used[3].offset),
        force.scale,
    )


@kernel
def current_to_code(current_a: float) -> int:
    """Code for the D/A that drives `current_a`; truncated and clipped as the program does, zero for a NaN.

    c = trunc(u * 2048 / 360 mA) in -2048..2047, code = 2048 + trunc(3/5 c).
    """
    scaled = current_a * COUNTS_PER_A
    counts = 0
    if scaled >= MAX_COUNTS:
        counts = MAX_COUNTS
    elif scaled <= MIN_COUNTS:
        counts = MIN_COUNTS
    elif scaled == scaled:  # not a NaN
        counts = int(scaled)
    if counts >= 0:
        return ZERO_CODE + counts * REDUCTION_NUMERATOR // REDUCTION_DENOMINATOR
    return ZERO_CODE - (-counts * REDUCTION_NUMERATOR // REDUCTION_DENOMINATOR)


@kernel
def code_to_current(code: int) -> float:
    """Valve current in A that a D/A code drives."""
    return (code - ZERO_CODE) * A_PER_CODE
