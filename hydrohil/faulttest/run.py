"""The fault test in one call: rows of the matrix, tried in their ways, with cells of its own."""

import time
from collections.abc import Callable, Iterable
from datetime import datetime
from pathlib import Path
from typing import NamedTuple

from hydrohil.cell.connection import service_options
from hydrohil.cell.processes import Place
from hydrohil.faulttest.execution import Execution, Settings, total
from hydrohil.faulttest.matrix import find_rows
from hydrohil.faulttest.report import Report
from hydrohil.faulttest.rig import Rig, lockstep_extra
from hydrohil.faulttest.trial import Trial
from hydrohil.reproduction.report import machine
from hydrohil.shared.compiled.kernel import source_version

PLACE = Place("faults", 7650)  # its ports lie beside those of a cell that is up
LOCKSTEP_PORTS = 12  # beyond those of the other cells that the fault test may have
TRIPS = Path("runs/faults/trips")


class FaultTestProgress(NamedTuple):
    """A trial that begins, or one that has ended."""

    title: str  # its row and way
    done: int  # trials so far
    total: int
    trial: Trial | None  # what it showed; None: it begins


def run_fault_tests(
    rows: Iterable[str] = (),
    *,
    trials: int = 5,
    seed: int = 0,
    quick: bool = False,
    place: Place = PLACE,
    realtime: bool = True,
    lease_ms: float | None = None,
    trips_folder: str | Path = TRIPS,
    progress: Callable[[FaultTestProgress], object] = lambda _: None,
) -> Report:
    """Try the rows of these numbers ("1", "5b"; none: all of them), each as often as it needs and at most `trials` times.

    `quick` leaves out what takes the wall clock. Cells of its own are brought up at `place` and beside it, with a lease of
    `lease_ms` (None: chosen from this host's lateness), and ended. Trip reports of these cells go to `trips_folder`.
    `seed` decides phases, noise and jitter.

    Raises UnknownRowError before anything is started. A KeyboardInterrupt ends the test: the report says `interrupted` and holds
    what was complete. A fault that was not survived raises nothing: see `Report.exit_status`.
    """
    chosen, settings = find_rows(rows), Settings(trials, seed, quick)
    began, created_at = time.perf_counter(), datetime.now().astimezone().isoformat(" ", "seconds")
    restarted: list[str] = []
    extra = service_options(lease_ms, realtime=realtime) | {"recorder": ["--trips", str(trips_folder)]}
    beside = place._replace(cell=f"{place.cell}-lockstep", port=place.port + LOCKSTEP_PORTS)
    rig = Rig(place, extra, restarted.append)
    rigs = {"L": Rig(beside, lockstep_extra(extra), restarted.append), "W": rig}
    execution = Execution(chosen, rigs, settings, _counted(total(chosen, settings), progress))
    interrupted = False
    try:
        execution.play()
    except KeyboardInterrupt:
        interrupted = True
    return Report(
        results=execution.results(),
        trials=trials,
        seed=seed,
        lease_ms=rig.lease_ms,
        interrupted=interrupted,
        source_version=source_version(),
        created_at=created_at,
        duration_s=time.perf_counter() - began,
        machine=machine(),
        restarted=tuple(restarted),
    )


def _counted(trials: int, progress: Callable[[FaultTestProgress], object]) -> Callable[[str, Trial | None], None]:
    """What the execution reports, with the number of trials so far."""
    done = 0

    def count(title: str, trial: Trial | None) -> None:
        nonlocal done
        done += trial is not None
        progress(FaultTestProgress(title, done, trials, trial))

    return count
