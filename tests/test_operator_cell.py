"""Processes of a cell: none is left when `stop` returns."""

import subprocess
import sys
from pathlib import Path

from services.operator import cell as cells

DEAF = "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); print(flush=True); time.sleep(60)"
MILD = "import time; print(flush=True); time.sleep(60)"


def started(program: str) -> subprocess.Popen[bytes]:
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.readline()
    return process


def test_stop_ends_the_deaf_too_and_returns_when_all_are_gone(monkeypatch):
    monkeypatch.setattr(cells, "_STOP_S", 0.2)
    processes = [started(MILD), started(DEAF)]
    cells.stop(process.pid for process in processes)
    for process in processes:
        stat = Path(f"/proc/{process.pid}/stat")
        assert not stat.exists() or stat.read_text().rsplit(")", 1)[1].split()[0] == "Z"


def test_a_process_that_is_gone_already_is_no_trouble():
    process = started(MILD)
    process.kill()
    process.wait()
    cells.stop([process.pid])
