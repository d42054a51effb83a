"""`hydrohil qualify` with real processes: everything is measured, and nothing is left."""

import json
import math
import os
import signal
import subprocess
from pathlib import Path

import pytest
from live_cell import begun, end, own_place, processes, until

from shared import cache

pytestmark = pytest.mark.live


@pytest.fixture
def own_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A record of its own beside the compiled kernels of everybody."""
    kernels, mine = cache.folder() / "kernels", tmp_path / "cache"
    kernels.mkdir(parents=True, exist_ok=True)
    mine.mkdir()
    (mine / "kernels").symlink_to(kernels)
    monkeypatch.setenv("HYDROHIL_CACHE", str(mine))
    return mine


def left(cell: str) -> list[str]:
    """Command lines of probes and services of that cell which live."""
    found = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout.splitlines()
    return [line for line in found if cell in line and "python" in line]


def test_everything_is_measured_and_a_trial_of_a_second_signs_nothing(own_cache: Path, tmp_path: Path):
    place, file = own_place(), tmp_path / "host.json"
    run = begun(place, "qualify", "--quick", "--seconds", "1", "--rate-hz", "100", "--json", str(file))
    out, err = run.communicate(timeout=120)
    assert run.returncode == 1, out + err
    told = json.loads(file.read_text())
    (trial,) = told["trials"]
    assert (trial["period_ns"], trial["signed"]) == (10_000_000, False)
    for name in ("wake_ups_us", "limit_us", "ping_us"):
        assert 0.0 <= trial[name]["p50"] <= trial[name]["p99"] <= trial[name]["p999"] <= trial[name]["max"] < math.inf
    assert trial["ping_lost"] < 100
    if trial["ended"] == "":
        assert trial["samples"] >= 100 and trial["accepted_us"]["p50"] > 0.0
        assert any("too few" in reason for reason in trial["reasons"])
        assert not (own_cache / "qualifications").exists()
    assert not processes(place) and not left(place.cell)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_an_interrupted_qualification_leaves_no_process(own_cache: Path, number: int):
    place = own_place()
    run = begun(place, "qualify", "--quick", "--rate-hz", "100")
    try:
        until(lambda: any("echo" in line for line in left(place.cell)), "the ping-pong runs")
    finally:
        status, words = end(run, number)
    assert status == (130 if number == signal.SIGINT else -number), words
    until(lambda: not left(place.cell), "nothing is left")
    assert not (own_cache / "qualifications").exists()
    assert os.path.isdir(own_cache)
