"""`hydrohil`: the entry point. Each command imports what it needs, so that a service starts fast."""

import sys
import traceback
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer

from hydrohil.cli import (  # noqa: F401 (each registers its commands)
    analysis_commands,
    campaign_command,
    cell_commands,
    experiment_commands,
    explain_command,
    faults_command,
    inject_command,
    qualify_command,
    reproduce_command,
    service_commands,
    set_command,
    trip_command,
    tune_command,
)
from hydrohil.cli.options import app
from hydrohil.shared import cache
from hydrohil.shared.exit_status import EXIT_BUG, EXIT_USAGE

EXTRAS = {  # packages that a service on a small host does not need, and the extra that installs each
    "control": "analysis",
    "dask": "campaign",
    "distributed": "campaign",
    "jinja2": "report",
    "junitparser": "report",
    "matplotlib": "all",
    "pyarrow": "campaign",
    "scipy": "analysis",
}


def _print_version(show: bool) -> None:
    if show:
        from importlib.metadata import PackageNotFoundError, version

        from hydrohil.shared.compiled.kernel import source_version

        try:
            number = version("hydrohil")
        except PackageNotFoundError:
            number = "(not installed)"
        print(f"hydrohil {number}, sources {source_version()}")
        raise typer.Exit


@app.callback()
def hydrohil(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print version and hash of the sources.")
    ] = False,
) -> None:
    """Distributed hardware-in-the-loop rig for force-controlled hydraulic manipulators."""


def main() -> None:
    """Entry point. An unexpected error gives one line, a file with the traceback, and an exit status of its own."""
    try:
        app()
    except ModuleNotFoundError as missing:
        package = (missing.name or "").partition(".")[0]
        if package not in EXTRAS:
            sys.exit(_report_bug(missing))
        print(f"{package} is not installed: pip install 'hydrohil[{EXTRAS[package]}]'", file=sys.stderr)
        sys.exit(EXIT_USAGE)
    except Exception as error:
        sys.exit(_report_bug(error))


def _report_bug(error: Exception) -> int:
    """The traceback goes into a file, one line to the terminal."""
    moment = datetime.now(UTC).strftime("%Y-%m-%dT%H-%M-%SZ")
    file = cache.folder() / "errors" / f"{moment}.txt"
    text = "".join(traceback.format_exception(error))
    what = repr(f"{type(error).__name__}: {error}"[:200])
    print(f"unexpected error, a fault of hydrohil's own: {what}; {_kept(file, text)}", file=sys.stderr)
    return EXIT_BUG


def _kept(file: Path, text: str) -> str:
    """Where the traceback is; it follows where the file cannot be written."""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"{sys.argv}\n\n{text}", encoding="utf-8")
    except OSError as error:
        return f"{file} cannot be written ({error.strerror or error}):\n{text}"
    return f"see {file}"


if __name__ == "__main__":
    main()
