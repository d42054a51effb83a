"""What every command of `hydrohil` shares: the application, its consoles, its options."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated
from unicodedata import category

import typer
from rich.console import Console

from hydrohil.shared.errors import HydrohilError
from hydrohil.shared.exit_status import EXIT_INTERRUPTED, EXIT_USAGE
from hydrohil.shared.transport.endpoints import network

if TYPE_CHECKING:
    from hydrohil.cell.cell import Cell
    from hydrohil.cell.processes import Place

app = typer.Typer(
    help="Distributed hardware-in-the-loop rig for force-controlled hydraulic manipulators.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)
# The chapters of `hydrohil --help`.
EXPERIMENTS, RUNNING_CELL, STUDIES = "Experiments", "A cell that runs", "Studies of an experiment"
CONFIDENCE, SERVICES = "Host, faults, causes", "Services, one process each"

console = Console(width=None if sys.stdout.isatty() else 120)
_NO_PRINT = ("Cc", "Cf", "Cs", "Zl", "Zp")  # control, direction and line characters: a terminal obeys them
errors = Console(stderr=True, highlight=False, soft_wrap=True)

CellName = Annotated[str, typer.Option("--cell", help="Name of the cell.")]
Port = Annotated[int, typer.Option("--port", help="First of the cell's four ports.", min=1024, max=65000)]
Hosts = Annotated[
    str, typer.Option("--hosts", metavar="SERVICE=ADDRESS,...", help="Where services run; one not named: on 127.0.0.1.")
]
Router = Annotated[
    str, typer.Option("--router", metavar="tcp/ADDRESS:PORT", help="Connect to this router instead of the services.")
]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="PATH=VALUE", help="Change one value, as TOML: controller.acting.rotate=false."),
]
Injected = Annotated[
    list[str] | None,
    typer.Option("--inject", metavar="FAULT", help="Break something: 'KIND TARGET [value=V] [at=SECONDS] [for=SECONDS]'."),
]
Unqualified = Annotated[
    bool,
    typer.Option("--unqualified", help="On the real clock, above the rate that `hydrohil qualify` has qualified for this host."),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]


def fail(message: object, status: int) -> typer.Exit:
    """One line on stderr; raise what is returned."""
    errors.print(printable(str(message)), style="red", markup=False)
    return typer.Exit(status)


def printable(text: str) -> str:
    """`text` with an escape such as `\\x1b` for each character that a terminal would obey; lines stay lines."""
    return "".join(ascii(letter)[1:-1] if category(letter) in _NO_PRINT and letter not in "\n\t" else letter for letter in text)


def place_of(cell: str, port: int, hosts: str, router: str) -> "Place":
    """Where a cell is; exit 2, with one line, where `--hosts` or `--router` say nothing."""
    from hydrohil.cell.processes import Place

    try:
        return Place(cell, port, network(hosts, router))
    except ValueError as error:
        raise fail(error, EXIT_USAGE) from None


def make_folders(*files: Path | None) -> None:
    """Make the folder of every file that a command will write; exit 2 where that, or a file there, is impossible.

    Only in the working folder: elsewhere a folder that is missing is more likely a path that was mistyped.
    """
    for path in files:
        if path is not None and not path.parent.exists() and not path.resolve().is_relative_to(Path.cwd().resolve()):
            raise fail(f"{path}: its folder does not exist: make it, or name a file in the working folder", EXIT_USAGE)
        try:
            if path is not None:
                path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise fail(f"{path}: its folder cannot be created ({error.strerror}): name another", EXIT_USAGE) from None
        if path is not None and path.is_dir():
            raise fail(f"{path}: is a folder: name a file", EXIT_USAGE)
        if path is not None and not os.access(path if path.exists() else path.parent, os.W_OK):
            raise fail(f"{path}: cannot be written (permission denied): name another", EXIT_USAGE)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Exit 2, with one line, where `path` cannot be written, because a full disk is not a failed claim."""
    try:
        yield
    except OSError as error:
        raise fail(f"{path}: cannot be written ({error.strerror or error}): make room or name another", EXIT_USAGE) from None


@contextmanager
def failing(
    interrupted: str = "interrupted", *, interrupted_status: int = EXIT_INTERRUPTED, refused: int | None = None
) -> Iterator[None]:
    """Turn an error of the library into one line and an exit status; `refused` is that of a refusal, if it differs."""
    try:
        yield
    except HydrohilError as error:
        from hydrohil.cell.processes import RefusedError

        status = error.exit_status if refused is None or not isinstance(error, RefusedError) else refused
        raise fail(error, status) from None
    except KeyboardInterrupt:
        raise fail(interrupted, interrupted_status) from None


@contextmanager
def attached(
    cell: str, port: int, hosts: str = "", router: str = "", *, interrupted: str = "interrupted", refused: int | None = None
) -> Iterator["Cell"]:
    """A cell that is up; where it refuses or does not answer, one line and an exit status."""
    from hydrohil.cell.cell import Cell

    with failing(interrupted, refused=refused), Cell.attach(cell, port, hosts=hosts, router=router) as found:
        yield found
