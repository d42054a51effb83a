"""Command line and environment of a child process, which imports nothing from the working folder.

A user's folder may hold `shared/`, `queue.py` or `rerun.py`: `python -m` alone would put it before the standard library.
"""

import os
import sys
from pathlib import Path

import hydrohil

_PARENT = Path(hydrohil.__file__).parent.parent  # the folder that holds the package


def python_module(module: str) -> list[str]:
    """Start of the command line that runs `module`; give its process `environment()` too."""
    return [sys.executable, "-P", "-m", module]


def python_program(text: str) -> list[str]:
    """Start of the command line that runs the program `text`, which imports nothing of ours."""
    return [sys.executable, "-P", "-c", text]


def environment() -> dict[str, str]:
    """This process's environment; with the package's folder on the path where this process found it in the working folder."""
    if sys.path and Path(sys.path[0]).resolve() == _PARENT.resolve():
        kept = os.environ.get("PYTHONPATH")
        return {**os.environ, "PYTHONPATH": str(_PARENT) + (f"{os.pathsep}{kept}" if kept else "")}
    return dict(os.environ)
