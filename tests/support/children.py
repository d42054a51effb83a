"""Command line and environment of a child process that runs a module of these tests."""

import os
from pathlib import Path

from hydrohil.shared.host.child import python_module

ROOT = Path(__file__).resolve().parents[2]


def support_module(module: str) -> list[str]:
    """Start of the command line that runs `module`; give its process `support_environment()` too."""
    return python_module(module)


def support_environment() -> dict[str, str]:
    """This process's environment, with the folder of the tests on the path: they are not installed."""
    kept = os.environ.get("PYTHONPATH")
    return {**os.environ, "PYTHONPATH": str(ROOT) + (f"{os.pathsep}{kept}" if kept else "")}
