"""`hydrohil reproduce` in a real cell."""

import json
from pathlib import Path

import pytest

from hydrohil.reproduction.plan import find_figure
from hydrohil.reproduction.play import judge_figure, play
from tests.support.live_cell import LEASE_MS, hydrohil, own_place

FIGURE = find_figure("fig-4-24")


@pytest.mark.live
def test_lockstep_shows_what_the_local_clock_shows(tmp_path: Path):
    arguments = ("--clock", "lockstep", "--permit-ttl-ms", LEASE_MS, "--out", str(tmp_path), "--json", str(tmp_path / "r.json"))
    run = hydrohil(own_place(), "reproduce", FIGURE.name, *arguments)
    assert run.returncode in (0, 1), run.stdout + run.stderr
    (figure,) = json.loads((tmp_path / "r.json").read_text())["figures"]
    local = judge_figure(FIGURE, {FIGURE.name: play(FIGURE.subject, 0)})
    assert [claim["measured"] for claim in figure["claims"]] == [[verdict.measured] for verdict in local.verdicts]
