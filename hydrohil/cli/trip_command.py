"""`hydrohil trip`: a trip report again, as text, JSON, tables or a page with plots."""

import csv
import json
from pathlib import Path
from typing import Annotated, Any

import typer

from hydrohil.cli.options import RUNNING_CELL, AsJson, app, console, fail, failing, make_folders, writing
from hydrohil.shared.exit_status import EXIT_USAGE


@app.command(rich_help_panel=RUNNING_CELL)
def trip(
    file: Annotated[Path | None, typer.Argument(help="A report; default: the newest in runs/trips.")] = None,
    as_json: AsJson = False,
    csv_folder: Annotated[Path | None, typer.Option("--csv", help="Write every signal, one table a topic.")] = None,
    html: Annotated[Path | None, typer.Option(help="Write a page with plots; it needs no network.")] = None,
) -> None:
    """Show why and how the rig tripped: rule, numbers, ages of every hop, counters; the last 10 s of all signals.

    Examples: `hydrohil trip`, `hydrohil trip --csv runs/signals`, `hydrohil trip --html runs/trip.html`
    """
    from hydrohil.cli.report import show_trip

    path, document = _document(file)
    if csv_folder is not None:
        make_folders(csv_folder / "any.csv")
        _write_tables(document["signals"], csv_folder)
    if html is not None:
        from hydrohil.pages.trip_page import page

        make_folders(html)
        with writing(html):
            html.write_text(page(document))
    if as_json:
        print(json.dumps({name: value for name, value in document.items() if name != "signals"}, indent=2))
    else:
        of = f", experiment {document['experiment']}" if document["experiment"] else ""
        console.print(f"[bold]{document['utc']}[/]  cell {document['cell']}{of}", highlight=False, soft_wrap=True)
        show_trip(console, document, str(path))


def _document(file: Path | None) -> tuple[Path, Any]:
    """The report that is asked for; exit 2 where there is none."""
    from hydrohil.recording.trips import newest_trip_file, read_trip

    with failing():
        found = file or newest_trip_file()
        try:
            return found, read_trip(found)
        except OSError as error:
            raise fail(f"{found}: {error.strerror}", EXIT_USAGE) from None


def _write_tables(signals: dict[str, dict[str, list[Any]]], folder: Path) -> None:
    """`plant-sample.csv` and so on; an empty cell is no number."""
    for topic, table in signals.items():
        path = folder / f"{topic.replace('/', '-')}.csv"
        with writing(path), path.open("w", newline="") as out:
            lines = csv.writer(out)
            lines.writerow(table)
            lines.writerows(zip(*table.values(), strict=True))
