"""Counts to physical units and back: the converters of the thesis' program (Appendix F, `out_d_to_a`, `get_a_to_d`)."""

from typing import NamedTuple

from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.machine.description import Channel, Drive
from hydrohil.shared.machine.unimate import UNIMATE

ZERO_CODE = UNIMATE.drive.zero_code  # of the gate, which takes no limit from a message


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
def current_to_code(drive: Drive, current_a: float) -> int:
    """Code for the D/A that drives `current_a`; truncated and clipped as the program does, zero for a NaN.

    c = trunc(u counts_per_a) in its range, code = zero + trunc(numerator c / denominator); the Unimate's are 2048 / 360 mA
    and 3/5.
    """
    scaled = current_a * drive.counts_per_a
    counts = 0
    if scaled >= drive.max_counts:
        counts = drive.max_counts
    elif scaled <= drive.min_counts:
        counts = drive.min_counts
    elif scaled == scaled:  # not a NaN
        counts = int(scaled)
    if counts >= 0:
        return drive.zero_code + counts * drive.numerator // drive.denominator
    return drive.zero_code - (-counts * drive.numerator // drive.denominator)


@kernel
def code_to_current(drive: Drive, code: int) -> float:
    """Valve current in A that a D/A code drives."""
    return (code - drive.zero_code) * drive.a_per_code
