"""What the DAQ reads of a machine whose sensors are broken.

A jump, a drift, a gain and noise of the force lie before the gauge's amplifier, which limits them; what is stuck, garbled
or missing lies after the converter. The ground truth is never changed.
"""

import math
from typing import Any

from hydrohil.services.plant.faults import (
    ACTION,
    CHANNEL,
    DRIFT,
    DROPOUT,
    FIRST,
    FORCE_CHANNEL,
    GAIN,
    GARBAGE,
    NOISE,
    OFFSET,
    STUCK,
    VALUE,
    WRAP,
    Held,
    Readings,
    acts,
    drawn,
    put,
)
from hydrohil.services.plant.machine import MachineState, contact_force
from hydrohil.services.plant.params import ContactParams, MachineParams
from hydrohil.services.plant.sensors import MASK, MAX_FORCE_COUNTS, MIN_FORCE_COUNTS, amplified_counts, encoder_counts, gauge_n
from hydrohil.shared.compiled.kernel import kernel

FORCE_CODES = MAX_FORCE_COUNTS - MIN_FORCE_COUNTS + 1


@kernel
def faulty_force_n(table: Any, tick: int, reading_n: float, noise_n: float) -> float:
    """What the amplifier gets instead of force, bias and noise, in N.

    A drift starts from the last sample that was true.
    """
    for i in range(len(table)):
        row = table[i]
        action, value = int(row[ACTION]), float(row[VALUE])
        if row[CHANNEL] == FORCE_CHANNEL and acts(row, tick):
            if action == OFFSET:
                reading_n += value
            elif action == DRIFT:
                reading_n += value * (tick - float(row[FIRST]) + 1.0)
            elif action == GAIN:
                reading_n *= value
            elif action == NOISE:
                reading_n += (value - 1.0) * noise_n
    return reading_n


@kernel
def faulty_count(row: Any, tick: int, count: int, last: int, mask: int) -> int:
    """A counter under one row; it wraps at its bits."""
    action, value = int(row[ACTION]), float(row[VALUE])
    if action == STUCK:
        return last
    if action == GARBAGE:
        return drawn(row, tick, mask + 1)
    if action == DROPOUT:
        return 0
    if action == OFFSET:
        return (count + math.floor(value)) & mask
    if action == DRIFT:
        return (count + math.floor(value * (tick - float(row[FIRST]) + 1.0))) & mask
    if action == NOISE:
        reach = math.floor(value)
        return (count + drawn(row, tick, 2 * reach + 1) - reach) & mask
    if action == WRAP:
        return count ^ ((mask + 1) // 2)
    return count


@kernel
def faulty_code(row: Any, tick: int, counts: int, last: int) -> int:
    """Counts of the gauge under one row."""
    action = int(row[ACTION])
    if action == STUCK:
        return last
    if action == GARBAGE:
        return drawn(row, tick, FORCE_CODES) + MIN_FORCE_COUNTS
    if action == DROPOUT:
        return MIN_FORCE_COUNTS
    return counts


@kernel
def faulty_readings(table: Any, tick: int, readings: Readings, held: Held) -> Readings:
    """What the DAQ reads of what the converters gave."""
    counts, force = readings
    links = (counts[0], counts[1], counts[2])
    last_counts, last_force = held.readings if held.known == 1 else readings
    for i in range(len(table)):
        row = table[i]
        if row[ACTION] <= WRAP and acts(row, tick):
            channel = int(row[CHANNEL])
            if channel == FORCE_CHANNEL:
                force = faulty_code(row, tick, force, last_force)
            else:
                links = put(links, channel, faulty_count(row, tick, links[channel], last_counts[channel], MASK[channel]))
    return (links[0], links[1], links[2], counts[3], counts[4]), force


@kernel
def faulty_sense(
    state: MachineState, machine: MachineParams, contact: ContactParams, noise_n: float, table: Any, tick: int, held: Held
) -> Readings:
    """`machine.sense` under faults; without any acting row it gives the same bits."""
    counts = encoder_counts(state.q, machine.q4_rad)
    reading_n = gauge_n(machine, contact_force(state, machine, contact), noise_n)
    force = amplified_counts(machine, faulty_force_n(table, tick, reading_n, noise_n))
    return faulty_readings(table, tick, (counts, force), held)
