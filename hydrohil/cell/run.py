"""One run in a live cell from load to verdict, recorded on request."""

import time
from pathlib import Path
from typing import Any

from hydrohil.cell.processes import CellError, ask
from hydrohil.cell.recording import Note, abandon_recording, begin_recording, finish_recording
from hydrohil.cell.session import Live, Progress, run_live
from hydrohil.cell.trip_file import recorded_file
from hydrohil.experiment.experiment import Experiment, warnings
from hydrohil.experiment.run import Run, verdicts_of
from hydrohil.shared.host.qualified import NOT_QUALIFIED
from hydrohil.shared.transport.bus import Bus


def run_in_cell(
    bus: Bus,
    experiment: Experiment,
    seed: int,
    clock: str,
    *,
    record: Path | None,
    unqualified: bool,
    progress: Progress,
    note: Note,
) -> Run:
    """Run `experiment` in the cell of `bus`. Raises CellError, with the trip's report where one ended the run early."""
    status = ask(bus, "supervisor", "status")
    qualification = status.get("qualification")
    if clock == "real" and qualification is None:
        note(f"note: {status.get('qualified', NOT_QUALIFIED)}")
    recorded = record is not None and begin_recording(bus, experiment, record, qualification, note)
    began = time.perf_counter()
    try:
        live = run_live(bus, experiment, seed, clock, progress, unqualified=unqualified)
    except BaseException as error:
        if recorded:
            abandon_recording(bus, experiment)
        if isinstance(error, CellError) and error.trip_report is not None:
            error.trip_file = recorded_file(error.trip_report, bus)
        raise
    run = _judged(experiment, seed, clock, live, time.perf_counter() - began, qualification)
    for line in run.warnings[len(warnings(experiment)) :]:
        note(f"warning: {line}")
    if recorded:
        run = run._replace(recording=finish_recording(bus, run, note))
    return run if run.trip_report is None else run._replace(trip_file=recorded_file(run.trip_report, bus))


def _judged(experiment: Experiment, seed: int, clock: str, live: Live, wall_s: float, qualification: Any) -> Run:
    """The run with the verdict on each claim."""
    known = warnings(experiment)
    return Run(
        experiment,
        clock=clock,
        seed=seed,
        trace=live.trace,
        verdicts=verdicts_of(experiment, live.trace, live.tripped),
        trip=live.tripped,
        gap=live.gap,
        wall_s=wall_s,
        latencies=live.status.get("plant", {}).get("counters", {}),
        warnings=known + tuple(line for line in live.warnings if line not in known),
        process_faults=live.process_faults,
        changed_by_hand=live.changed,
        trip_report=live.trip_report,
        qualification=qualification,
    )
