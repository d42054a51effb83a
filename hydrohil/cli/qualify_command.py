"""`hydrohil qualify`: is this host good enough for this rate? A table, a grade, and the highest rate that is qualified."""

import json
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrohil.cli.options import CONFIDENCE, CellName, Port, app, console, fail, make_folders, writing
from hydrohil.cli.reproduce_command import write_whole
from hydrohil.shared.exit_status import EXIT_TRANSPORT, EXIT_USAGE
from hydrohil.shared.host.qualified import hertz, record_file, this_host, words
from hydrohil.shared.units import NS_PER_S, SUBSTEP_NS

if TYPE_CHECKING:
    from hydrohil.qualification.grading import Figures
    from hydrohil.qualification.host import Found
    from hydrohil.qualification.measure import Measured, Wish
    from hydrohil.qualification.record import Tried

RATES_HZ = (1000.0, 500.0, 222.2, 100.0)  # tried from the highest down, until one is qualified
FIRST_PORT = 7750  # beside a cell that is up, and beside the battery's
SHORTEST_SUBSTEPS, LONGEST_SUBSTEPS = 20, 200  # sampling periods that a plant accepts
LOOP_S, BASELINE_S = 20.0, 5.0
QUICK_BASELINE_S, QUICK_SAMPLES = 1.0, 1000


@app.command(rich_help_panel=CONFIDENCE)
def qualify(
    rate_hz: Annotated[
        float | None, typer.Option(metavar="HZ", help="Try this rate alone (100 to 1000); default: 1000, 500, 222.2, 100.")
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(min=0.5, max=3600.0, help="Of the loop's trial at each rate; a signature needs 1000 samples.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="As short as a signature allows: 1000 samples at each rate.")] = False,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write every number.")] = None,
    realtime: Annotated[
        bool, typer.Option(help="Ask for real-time scheduling; with and without it there is a record each.")
    ] = True,
    cell: CellName = "qualify",
    port: Port = FIRST_PORT,
) -> None:
    """Measure this host and grade it for a sampling rate; the highest rate that it qualifies goes on record.

    Wake-ups, the machine's own limit, a bare ping-pong, then the full loop in a private cell. From then on a cell on this host
    does not arm above the qualified rate on the real clock, unless told `--unqualified`.

    Exit status: 0 qualified, 1 no rate that was tried is qualified, 2 usage, 5 no cell comes up,
    130 interrupted (nothing is recorded).

    Examples: `hydrohil qualify`, `hydrohil qualify --rate-hz 500 --seconds 60`, `hydrohil qualify --quick --json runs/host.json`
    """
    from hydrohil.cell.processes import CellError, Place
    from hydrohil.qualification.host import found, load_now
    from hydrohil.qualification.measure import Wish

    periods = _periods(rate_hz)
    make_folders(json_file)
    tried: list[Tried] = []
    granted: dict[str, bool] = {}
    load = load_now()
    try:
        for period in periods:
            loop_s = seconds or (QUICK_SAMPLES * period * SUBSTEP_NS / NS_PER_S if quick else LOOP_S)
            wish = Wish(Place(cell, port), loop_s, QUICK_BASELINE_S if quick else BASELINE_S, realtime)
            measured = _with_bar(wish, period)
            granted = measured.granted
            tried.append(_judged(measured.figures))
            if tried[-1].verdict.qualified:
                break
    except CellError as error:
        raise fail(error, EXIT_TRANSPORT) from None
    except KeyboardInterrupt:
        raise fail("interrupted: nothing is recorded", 130) from None
    _finish(found(granted, load), tried, json_file, fifo=granted["fifo"])


def _periods(rate_hz: float | None) -> list[int]:
    """Sub-steps of the sampling periods to try; exit 2 where the plant accepts none such."""
    periods = [
        round(NS_PER_S / (rate * SUBSTEP_NS)) if rate > 0.0 else 0 for rate in ([rate_hz] if rate_hz is not None else RATES_HZ)
    ]
    if not all(SHORTEST_SUBSTEPS <= period <= LONGEST_SUBSTEPS for period in periods):
        lowest, highest = (NS_PER_S / (period * SUBSTEP_NS) for period in (LONGEST_SUBSTEPS, SHORTEST_SUBSTEPS))
        raise fail(f"--rate-hz is {rate_hz:g} Hz: expected {lowest:g} to {highest:g} Hz", EXIT_USAGE)
    return periods


def _with_bar(wish: "Wish", period: int) -> "Measured":
    """One rate, with a bar."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from hydrohil.qualification.measure import STEPS, measure

    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    rate = hertz(period * SUBSTEP_NS)
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task(rate, total=STEPS * wish.baseline_s + wish.seconds)
        return measure(wish, period, lambda what, s: progress.update(task, description=f"{rate}: {what}", completed=s))


def _judged(figures: "Figures") -> "Tried":
    from hydrohil.qualification.grading import judge
    from hydrohil.qualification.record import Tried

    return Tried(figures, judge(figures), datetime.now().astimezone().isoformat(" ", "seconds"))


def _finish(facts: "Sequence[Found]", tried: "list[Tried]", json_file: Path | None, *, fifo: bool) -> None:
    """Show it, put it on record, say what is on record, write the file, end with the status."""
    from hydrohil.cli.qualify_report import as_plain, show
    from hydrohil.qualification.grading import is_evidence
    from hydrohil.qualification.record import keep

    show(console, facts, tried)
    host = this_host()
    with writing(path := record_file(host, fifo=fifo)):
        found = keep(path, host, tried)
    if not any(is_evidence(one.figures) for one in tried):
        console.print("too short to be put on record", highlight=False)
    elif found is not None:
        console.print(f"on record until the next boot: {words(found)}; {path}", highlight=False, markup=False, soft_wrap=True)
    told = as_plain(host, facts, tried, fifo=fifo)
    if json_file is not None:
        with writing(json_file):
            write_whole(json_file, json.dumps(told, indent=2) + "\n")
    raise typer.Exit(told["exit_status"])
