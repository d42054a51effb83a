"""`hydrohil qualify` with real processes: everything is measured, and nothing is left."""

import json
import math
import signal
import subprocess
from pathlib import Path

import pytest

from hydrohil.qualification.grading import judge
from hydrohil.qualification.record import RateTrial, keep
from hydrohil.shared import cache
from hydrohil.shared.host.child import environment
from hydrohil.shared.host.qualified import record_file, this_host
from tests.support.live_cell import LEASE_MS, begun, end, hydrohil, line, own_place, processes, swing, until
from tests.support.qualification_scene import GOOD

pytestmark = pytest.mark.live
SLOW = GOOD._replace(period_ns=10_000_000)


@pytest.fixture
def own_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A record of its own beside the compiled kernels of everybody."""
    kernels, mine = cache.folder() / "kernels", tmp_path / "cache"
    kernels.mkdir(parents=True, exist_ok=True)
    mine.mkdir()
    (mine / "kernels").symlink_to(kernels)
    monkeypatch.setenv("HYDROHIL_CACHE", str(mine))
    return mine


def test_everything_is_measured_and_a_trial_of_a_second_qualifies_nothing(own_cache: Path, tmp_path: Path):
    place, file = own_place(), tmp_path / "host.json"
    run = begun(place, "qualify", "--quick", "--seconds", "1", "--rate-hz", "100", "--json", str(file))
    out, err = run.communicate(timeout=120)
    assert run.returncode == 1, out + err
    written = json.loads(file.read_text())
    (trial,) = written["trials"]
    assert (trial["period_ns"], trial["qualified"]) == (10_000_000, False)
    for name in ("wake_ups_us", "limit_us", "ping_us"):
        assert 0.0 <= trial[name]["p50"] <= trial[name]["p99"] <= trial[name]["p999"] <= trial[name]["max"] < math.inf
    assert trial["ping_lost"] < 100
    if trial["ended"] == "":
        assert trial["samples"] >= 100 and trial["accepted_us"]["p50"] > 0.0
        assert any("too few" in reason for reason in trial["reasons"])
        assert not (own_cache / "qualifications").exists()
    assert not processes(place)


@pytest.mark.parametrize(
    ("number", "alive"),
    [(signal.SIGINT, 2), (signal.SIGKILL, 2), (signal.SIGINT, 3)],
    ids=["ctrl-c in the ping-pong", "killed in the ping-pong", "ctrl-c in the loop"],
)
def test_an_interrupted_qualification_leaves_no_process(own_cache: Path, number: int, alive: int):
    place = own_place()
    run = begun(place, "qualify", "--quick", "--rate-hz", "100")
    try:
        until(lambda: len(processes(place)) == alive, "both ends of the ping-pong, or the three services of the cell")
    finally:
        status, words = end(run, number)
    assert status == (130 if number == signal.SIGINT else -number), words
    until(lambda: not processes(place), "nothing is left")
    assert not (own_cache / "qualifications").exists()


def test_a_run_above_the_qualified_rate_is_refused_in_one_line_and_one_on_purpose_is_not(own_cache: Path, tmp_path: Path):
    host, late = this_host(), GOOD._replace(unanswered=400.0)
    for fifo in (False, True):  # whatever this machine grants
        keep(
            record_file(host, fifo=fifo),
            host,
            [RateTrial(one, judge(one), "yesterday") for one in (late, SLOW)],
        )
    place, file = own_place(), tmp_path / "r.json"
    arguments = ("run", swing(tmp_path), "--permit-ttl-ms", LEASE_MS, "--json", str(file))
    refused = subprocess.run(
        line(place, *arguments)[:-1], env=environment(), capture_output=True, text=True, check=False, timeout=120
    )
    assert refused.returncode == 2, refused.stdout + refused.stderr
    (said,) = refused.stderr.strip().splitlines()
    assert "222.2 Hz" in said and "100 Hz" in said and "hydrohil qualify" in said
    assert not file.exists() and not processes(place)
    allowed = hydrohil(place, *arguments)
    assert allowed.returncode != 2, allowed.stdout + allowed.stderr
    assert json.loads(file.read_text())["qualification"]["qualified_period_ns"] == SLOW.period_ns
