"""Faults of the emulated machine as a table of numbers, the same for live services and for the compiled rollout.

One row a fault: (action, channel, first tick, tick after the last, value, salt). The later row acts on what the earlier
one left. What is random is a function of (seed, channel, tick).
"""

import math
from typing import Any, NamedTuple

from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.faults import CONVERTERS, ENCODERS, FORCE, VALVES, Fault, ticks_of
from hydrohil.shared.draws import uniforms
from hydrohil.shared.units import NS_PER_S

STUCK, GARBAGE, DROPOUT, OFFSET, DRIFT, GAIN, NOISE, WRAP, SPOOL, LEAK, CONVERTER, SUPPLY = range(12)
ACTION, CHANNEL, FIRST, END, VALUE, SALT = range(6)
COLUMNS = 6
FORCE_CHANNEL = 3  # after the three encoders
FIRST_SALT_CHANNEL = 16  # of the seed's generator: apart from noise and jitter
WORD = 0xFFFFFFFF

Row = tuple[float, float, float, float, float, float]
Readings = tuple[tuple[int, int, int, int, int], int]  # encoder counters and counts of the gauge


class Held(NamedTuple):
    """What the converters gave last: a stuck one stays there. Without a last reading it stays at its first."""

    readings: Readings = ((0, 0, 0, 0, 0), 0)
    known: int = 0


_ACTIONS = {"garbage": GARBAGE, "dropout": DROPOUT, "offset": OFFSET, "drift": DRIFT, "gain": GAIN, "noise": NOISE} | {
    "wrap": WRAP,
    "leak": LEAK,
    "drop": SUPPLY,
}
_STUCK = dict.fromkeys(FORCE + ENCODERS, STUCK) | dict.fromkeys(VALVES, SPOOL) | dict.fromkeys(CONVERTERS, CONVERTER)
_CHANNELS = {target: link for targets in (ENCODERS, VALVES, CONVERTERS) for link, target in enumerate(targets)}


def fault_row(fault: Fault, seed: int, period_ns: int) -> Row:
    """The row of a valid fault of sensor or actuator; a drift's value is per tick, a salt is of (seed, channel)."""
    first, end = ticks_of(fault, period_ns)
    action = _STUCK[fault.target] if fault.kind == "stuck" else _ACTIONS[fault.kind]
    channel = FORCE_CHANNEL if fault.target in FORCE else _CHANNELS.get(fault.target, 0)
    value = fault.value * period_ns / NS_PER_S if action == DRIFT else fault.value
    salt = math.floor(float(uniforms(seed, FIRST_SALT_CHANNEL + channel, 0, 1)[0, 0]) * WORD)
    return float(action), float(channel), float(first), float(end), value, float(salt)


@kernel
def acts(row: Any, tick: int) -> bool:
    """Whether this row has begun and not ended."""
    return bool(row[FIRST] <= tick < row[END])


@kernel
def mixed(word: int) -> int:
    """A permutation of 32 bits (Wellons' lowbias32)."""
    word = (word ^ (word >> 16)) * 0x7FEB352D & WORD
    word = (word ^ (word >> 15)) * 0x846CA68B & WORD
    return word ^ (word >> 16)


@kernel
def drawn(row: Any, tick: int, count: int) -> int:
    """One of 0..count-1, a function of (seed, channel, tick) alone."""
    return mixed(mixed(tick & WORD) ^ int(row[SALT])) % count


@kernel
def put(values: tuple[int, int, int], place: int, value: int) -> tuple[int, int, int]:
    """`values` with another one at `place`."""
    return (
        value if place == 0 else values[0],
        value if place == 1 else values[1],
        value if place == 2 else values[2],
    )
