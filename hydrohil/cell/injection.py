"""Sends each fault to what plays it: the plant for the machine, receivers for the transport, the operator for processes.

One table says which groups an operator, or a trial, may ask for.
"""

from collections.abc import Callable, Iterable
from typing import Any

from hydrohil.cell.process_faults import inject_now
from hydrohil.cell.processes import LOOP, ask
from hydrohil.shared.contract.envelope import checked
from hydrohil.shared.contract.faults import ROWS, Fault, Group, Row, problem, row_of
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.impairment import paths_of


def by_plant(bus: Bus, fault: Fault) -> str:
    """Ask the plant to break its machine; returns what was done, in words. Raises CellError."""
    answer = ask(bus, "plant", "inject", fault=fault._asdict())
    return f"begins at sample {answer['number']}"


def by_receivers(bus: Bus, fault: Fault) -> str:
    """Ask every service at the end of a path to impair what it receives; a partition has two ends. Raises CellError."""
    receivers = [path.partition(">")[2] for path in paths_of(fault)]
    numbers = [ask(bus, receiver, "inject", fault=fault._asdict())["number"] for receiver in receivers]
    return f"begins at sample {max(numbers)}"


INJECTORS: dict[Group, Callable[[Bus, Fault], str]] = {  # into a cell that runs
    "sensor": by_plant,
    "actuator": by_plant,
    "transport": by_receivers,
    "process": inject_now,
}
SCHEDULED: tuple[Group, ...] = ("sensor", "actuator", "transport", "process")  # what is played of a trial's section [[faults]]


def inject(bus: Bus, fault: Fault) -> str:
    """Inject a fault that `refused` accepts; what was done, in words. Raises CellError."""
    return INJECTORS[row_of(fault).group](bus, fault)


def clear(bus: Bus) -> None:
    """End everything that was injected. Raises CellError."""
    for service in LOOP:
        ask(bus, service, "clear")


def refused(fault: Fault) -> str:
    """Why an operator cannot inject `fault`, one line; "" if he can."""
    try:
        checked(fault._asdict(), "fault", Fault)
    except ValueError as error:
        return str(error)
    return problem(fault) or _unplayed(fault, INJECTORS, "injected into a cell that runs")


def unplayable(faults: Iterable[Fault], clock: str) -> list[str]:
    """Why a trial on `clock` cannot have these faults, a line each."""
    found = (problem(fault, clock) or _unplayed(fault, SCHEDULED, "scheduled in a trial") for fault in faults)
    return [what for what in found if what]


def _unplayed(fault: Fault, groups: Iterable[Group], what: str) -> str:
    row = row_of(fault)
    if row.group in groups:
        return ""
    return f"{fault.kind} of {fault.target} cannot be {what}: only {', '.join(groups)} faults can; see `hydrohil inject --list`"


def bounds(row: Row) -> str:
    """Unit and bounds of a row's value; "" where it takes none."""
    return f"{row.low:g} .. {row.high:g} {row.unit}" if row.unit else ""


def listed() -> list[dict[str, Any]]:
    """Every row, as `hydrohil inject --list --json` prints it."""
    return [
        row._asdict() | {"clocks": row.clocks, "injected": row.group in INJECTORS, "scheduled": row.group in SCHEDULED}
        for row in ROWS
    ]


def words(fault: dict[str, Any]) -> str:
    """A fault of a status in a few words."""
    return f"{fault['kind']} {fault['target']}" + (f" {fault['value']:g}" if fault["value"] else "")
