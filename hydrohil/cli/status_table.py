"""What `hydrohil status` prints of each service."""

from typing import Any

from rich.table import Column, Table

from hydrohil.cell.emergency import drives
from hydrohil.cell.injection import words
from hydrohil.shared.contract.messages import GateState
from hydrohil.shared.contract.topics import SERVICES

Status = dict[str, Any]


def status_table(statuses: dict[str, Status]) -> Table:
    """A row a service."""
    table = Table("service", Column("state", overflow="fold"), "lost, discarded, counted against a link")
    for service in SERVICES:
        status = statuses.get(service)
        state = "[red]does not answer[/]" if status is None else _STATES[service](status) + _faults(status)
        table.add_row(service, state, _counts(status or {}))
    return table


def _counts(status: Status) -> str:
    """What a service did not use of the frames that came, a line a topic."""
    received: dict[str, dict[str, int]] = status.get("link_stats", {})
    lines = []
    for topic, counts in received.items():
        named = [f"{count} {name.replace('_', ' ')}" for name, count in counts.items() if name != "accepted"]
        lines += [f"{topic}: {', '.join(named)}"] * bool(named)
    return "\n".join(lines)


def _faults(status: Status) -> str:
    """What is broken on purpose, a line each."""
    broken: dict[str, list[dict[str, Any]]] = status.get("faults", {})
    return "".join(f"\n[yellow]fault {state}: {words(fault)}[/]" for state, faults in broken.items() for fault in faults)


def supervisor_state(status: Status) -> str:
    """Mode, rate that this host is qualified for, warnings."""
    warned = (f"[yellow]{line}[/]" for line in status["warnings"])
    return "\n".join([f"{status['mode']}  {status['words']}", status.get("qualified", ""), *warned])


def plant_state(status: Status) -> str:
    """Sample and gate; and the codes at the D/A where it does not do as the gate says."""
    gate = "open" if status["gate"] == GateState.OPEN else f"shut: {status['gate_cause']}"
    driven = status.get("dac_readback") or status["dac_counts"]
    held = f"\n[red]the gate has let other codes through, but {drives(driven)}[/]" if driven != status["dac_counts"] else ""
    return f"sample {status['number']}, gate {gate}, lease {status['lease_ms']:.1f} ms{held}"


def controller_state(status: Status) -> str:
    """Law, and what was changed since the load."""
    changed = [f"[yellow]changed: {line}[/]" for line in status.get("changed", ())]
    return "\n".join([f"law {status['law']}, {status['answered']} samples answered", *changed])


def recorder_state(status: Status) -> str:
    """The recording that is open, and the last trip's report."""
    recording = str(status.get("recording", {}).get("path") or "no recording open")
    trip = status.get("trip") or {}
    where = trip.get("path") or (f"[yellow]no file: {trip.get('failure')}[/]" if trip.get("failure") else "being written")
    return recording + (f"\nlast trip {trip['utc']}: {trip['cause']}, {where}" if trip else "")


_STATES = {"plant": plant_state, "controller": controller_state, "supervisor": supervisor_state, "recorder": recorder_state}
