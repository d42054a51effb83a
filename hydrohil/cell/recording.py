"""A recording of one run: opened before it, closed with its verdict. A cell without a recorder runs on without one."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from hydrohil.cell.processes import CellError, ask
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.run import Run
from hydrohil.shared.transport.bus import Bus

Note = Callable[[str], object]  # is given one line for an operator

_OPEN_S, _CLOSE_S = 10.0, 30.0


def begin_recording(bus: Bus, experiment: Experiment, path: Path, qualification: Any, note: Note) -> bool:
    """Ask the recorder to write to `path`; False, with a note, where there is no recorder or it refuses."""
    title = f"{experiment.name}: {experiment.title}"
    try:
        answer = ask(
            bus,
            "recorder",
            "record",
            _OPEN_S,
            path=str(path.resolve()),
            title=title,
            summary_markdown=f"# {title}",
            qualification=qualification,
        )
    except CellError as error:
        note(f"no recording: {error}")
        return False
    if answer.get("failure"):
        note(f"the recording is incomplete: {answer['failure']}")
    return True


def finish_recording(bus: Bus, run: Run, note: Note) -> str:
    """Close the recording with the run's verdict; returns its file, "" if the recorder was lost. What is missing is noted."""
    try:
        answer = ask(bus, "recorder", "finish", _CLOSE_S, summary_markdown=run.to_markdown())
    except CellError as error:
        note(f"the recorder was lost during the run: {error}")
        return ""
    for problem in (answer.get("failure"), f"{answer['gaps']} messages are missing in it" if answer.get("gaps") else ""):
        if problem:
            note(f"the recording is incomplete: {problem}")
    return str(answer.get("path", ""))


def abandon_recording(bus: Bus, experiment: Experiment) -> None:
    """Close the recording of a run that has no end."""
    bus.ask("recorder", "finish", {"summary_markdown": f"# {experiment.name}: ended early, no verdict"}, _OPEN_S)
