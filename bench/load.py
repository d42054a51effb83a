"""For benches that put a load on live cells: start a trial, ask whether it runs, and take the processor time of processes."""

import os
import time
from collections.abc import Iterable
from pathlib import Path

from hydrohil.cell import processes as cells
from hydrohil.cell.session import arm, load
from hydrohil.experiment.experiment import Experiment
from hydrohil.shared.contract.messages import Mode
from hydrohil.shared.transport.bus import Bus

TICK_S = 1.0 / os.sysconf("SC_CLK_TCK")
_LOOK_S = 0.1  # between two status requests; so few do not disturb the trial


def processor_s(pids: Iterable[int]) -> float:
    """Processor time that processes have used so far, all threads."""
    used = 0
    for pid in pids:
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
        used += int(fields[11]) + int(fields[12])
    return used * TICK_S


def begin(bus: Bus, experiment: Experiment, clock: str) -> None:
    """Load, arm, start."""
    load(bus, experiment, 0, clock, unqualified=True)
    arm(bus)
    cells.ask(bus, "supervisor", "start")


def goes_on(bus: Bus) -> bool:
    """Whether the trial still runs; waits a moment first."""
    time.sleep(_LOOK_S)
    return bool(cells.statuses(bus, ("supervisor",)).get("supervisor", {}).get("mode") == Mode.RUNNING.name)
