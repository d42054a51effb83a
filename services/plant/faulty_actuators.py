"""What the valves of a broken machine do: a D/A that holds its code, a spool that holds its place, leaks, a lost supply."""

import math
from typing import Any

from hydrohil.services.plant.faults import ACTION, CHANNEL, CONVERTER, LEAK, SPOOL, SUPPLY, VALUE, acts, put
from hydrohil.services.plant.params import LinkParams, MachineParams
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import LinkCounts

_LEAK_AT = LinkParams._fields.index("cross_leak_m3_per_s_pa")
_LAG_AT = LinkParams._fields.index("valve_lag_s")
_AFTER_LEAK, _AFTER_LAG = _LEAK_AT + 1, _LAG_AT + 1
_AFTER_SUPPLY = MachineParams._fields.index("supply_pressure_pa") + 1  # the fourth, after the links


@kernel
def faulty_codes(table: Any, tick: int, codes: LinkCounts, standing: LinkCounts) -> LinkCounts:
    """Codes at the D/A's output when `codes` are written to one that holds `standing`."""
    given = (codes[0], codes[1], codes[2])
    for i in range(len(table)):
        row = table[i]
        if row[ACTION] == CONVERTER and acts(row, tick):
            channel = int(row[CHANNEL])
            given = put(given, channel, standing[channel])
    return given


@kernel
def faulty_link(table: Any, tick: int, link: LinkParams, index: int) -> LinkParams:
    """A link with its leak multiplied; a spool that stays where it was is one with an infinite lag."""
    leak, lag_s = link.cross_leak_m3_per_s_pa, link.valve_lag_s
    for i in range(len(table)):
        row = table[i]
        if row[CHANNEL] == index and acts(row, tick):
            if row[ACTION] == LEAK:
                leak *= float(row[VALUE])
            elif row[ACTION] == SPOOL:
                lag_s = math.inf
    fields: Any = link[:_LEAK_AT] + (leak,) + link[_AFTER_LEAK:_LAG_AT] + (lag_s,) + link[_AFTER_LAG:]
    return LinkParams(*fields)


@kernel
def faulty_machine(table: Any, tick: int, machine: MachineParams) -> MachineParams:
    """The machine with what its valves, leaks and supply have lost."""
    supply_pa = machine.supply_pressure_pa
    for i in range(len(table)):
        row = table[i]
        if row[ACTION] == SUPPLY and acts(row, tick):
            supply_pa *= 1.0 - float(row[VALUE])
    links = (
        faulty_link(table, tick, machine.rotate, 0),
        faulty_link(table, tick, machine.down_up, 1),
        faulty_link(table, tick, machine.out_in, 2),
    )
    fields: Any = links + (supply_pa,) + machine[_AFTER_SUPPLY:]
    return MachineParams(*fields)
