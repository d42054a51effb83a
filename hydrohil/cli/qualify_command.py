"""`hydrohil qualify`: is this host good enough for this rate? A table, a grade, and the highest rate that is qualified."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrohil.cli.options import CONFIDENCE, CellName, Port, app, console, fail, make_folders, writing
from hydrohil.cli.reproduce_command import write_whole
from hydrohil.shared.exit_status import EXIT_TRANSPORT, EXIT_USAGE
from hydrohil.shared.host.qualified import hertz, words

if TYPE_CHECKING:
    from hydrohil.qualification.qualify import Qualification, QualificationProgress

_INTERRUPTED = 130


@app.command(rich_help_panel=CONFIDENCE)
def qualify(
    rate_hz: Annotated[
        float | None, typer.Option(metavar="HZ", help="Try this rate alone (100 to 1000); default: 1000, 500, 222.2, 100.")
    ] = None,
    seconds: Annotated[
        float | None,
        typer.Option(min=0.5, max=3600.0, help="Of the loop's trial at each rate; a qualification needs 1000 samples."),
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="As short as a qualification allows: 1000 samples at each rate.")
    ] = False,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write every number.")] = None,
    realtime: Annotated[
        bool, typer.Option(help="Ask for real-time scheduling; with and without it there is a record each.")
    ] = True,
    cell: CellName = "qualify",
    port: Port = 7750,
) -> None:
    """Measure this host and grade it for a sampling rate; the highest rate that it qualifies goes on record.

    Wake-ups, the machine's own limit, a bare ping-pong, then the full loop in a private cell. From then on a cell on this host
    does not arm above the qualified rate on the real clock, except with `--unqualified`.

    Exit status: 0 qualified, 1 no rate that was tried is qualified, 2 usage, 5 no cell comes up,
    130 interrupted (nothing is recorded).

    Examples: `hydrohil qualify`, `hydrohil qualify --rate-hz 500 --seconds 60`, `hydrohil qualify --quick --json runs/host.json`
    """
    from hydrohil.cell.processes import CellError, Place
    from hydrohil.qualification import qualify as qualification

    make_folders(json_file)
    try:
        with _Bar() as bar:
            result = qualification.qualify(
                qualification.RATES_HZ if rate_hz is None else (rate_hz,),
                seconds=seconds,
                quick=quick,
                realtime=realtime,
                place=Place(cell, port),
                record=False,
                progress=bar.show,
            )
    except qualification.RateError as error:
        raise fail(str(error).replace("rate_hz", "--rate-hz"), EXIT_USAGE) from None
    except CellError as error:
        raise fail(error, EXIT_TRANSPORT) from None
    except KeyboardInterrupt:
        raise fail("interrupted: nothing is recorded", _INTERRUPTED) from None
    _finish(result, json_file)


class _Bar:
    """A bar for the rate that is being measured."""

    def __init__(self) -> None:
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
        self._progress = Progress(*columns, console=console, transient=True)
        self._task = self._progress.add_task("", total=None)

    def __enter__(self) -> "_Bar":
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def show(self, now: "QualificationProgress") -> None:
        """One report of the qualification."""
        words = f"{hertz(now.period_ns)}: {now.step}"
        self._progress.update(self._task, description=words, total=now.total_s, completed=now.elapsed_s)


def _finish(result: "Qualification", json_file: Path | None) -> None:
    """Show it, put it on record, say what is on record, write the file, end with the status."""
    from hydrohil.cli.qualify_report import show
    from hydrohil.qualification.qualify import RecordError, recorded

    show(console, result)
    try:
        result = recorded(result)
    except RecordError as error:
        raise fail(error, EXIT_USAGE) from None
    if result.record_file is None:
        console.print("too short to be put on record", highlight=False)
    elif result.on_record is not None:
        line = f"on record until the next boot: {words(result.on_record)}; {result.record_file}"
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    if json_file is not None:
        with writing(json_file):
            write_whole(json_file, json.dumps(result.summary(), indent=2) + "\n")
    raise typer.Exit(result.exit_status)
