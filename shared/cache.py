"""Where what may be made again, or belongs to this host, is kept between runs."""

import os
from pathlib import Path


def folder() -> Path:
    """`HYDROHIL_CACHE`, or ~/.cache/hydrohil."""
    return Path(os.environ.get("HYDROHIL_CACHE", Path.home() / ".cache" / "hydrohil"))
