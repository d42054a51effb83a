"""The folder for compiled kernels, and for records of this host, between runs."""

import os
from pathlib import Path


def folder() -> Path:
    """`HYDROHIL_CACHE`, or ~/.cache/hydrohil."""
    return Path(os.environ.get("HYDROHIL_CACHE", Path.home() / ".cache" / "hydrohil"))
