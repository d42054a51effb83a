"""`python -m services.recorder`: record one cell."""

import argparse
from pathlib import Path

from services.recorder.service import main
from shared.bus import DEFAULT_PORT

parser = argparse.ArgumentParser(prog="python -m services.recorder", description=__doc__)
parser.add_argument("--cell", default="bench", help="name of the cell")
parser.add_argument("--port", type=int, default=DEFAULT_PORT, help="first port of the cell")
parser.add_argument("--folder", type=Path, default=Path("runs"), help="where recordings go")
parser.add_argument("--rrd", type=Path, help="record from the start into this file of the folder")
parser.add_argument("--live", type=int, metavar="PORT", help="serve a live view on this port")

if __name__ == "__main__":
    given = parser.parse_args()
    main(given.cell, given.port, given.folder, given.rrd, given.live)
