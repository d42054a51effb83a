"""A cell across hosts: a namespace for each service, a cable pulled for real: pytest -m slow tests/live/test_hosts.py -rs."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TRIED = (
    "ip link set lo up && ip link add switch type bridge && unshare -n true && "
    "ip link add one type veth peer name two && ip route add blackhole 192.0.2.9/32 && nsenter -t $$ -n true"
)


def impossible() -> str:
    """Why this machine makes no hosts of its own; "" if it does."""
    missing = [tool for tool in ("unshare", "nsenter", "ip") if shutil.which(tool) is None]
    if missing:
        return f"a cell across hosts is skipped: this machine has no {', no '.join(missing)}"
    tried = subprocess.run(["unshare", "-rn", "sh", "-c", TRIED], capture_output=True, text=True, check=False)
    return f"a cell across hosts is skipped: {tried.stderr.strip()}" if tried.returncode else ""


REASON = impossible()
pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.skipif(bool(REASON), reason=REASON or "possible")]


@pytest.mark.parametrize(("service", "cuts"), [("controller", 3), ("supervisor", 3), ("plant", 1)])
def test_a_host_whose_cable_is_pulled_leaves_the_valves_at_zero_and_nothing_resumes(service: str, cuts: int):
    line = ["unshare", "-rn", sys.executable, "-m", "tests.support.hosts_cell", service]
    made = subprocess.run(line, capture_output=True, text=True, check=False, cwd=ROOT, timeout=240)
    assert made.returncode == 0, made.stdout + made.stderr
    found = [json.loads(told) for told in made.stdout.splitlines()]
    assert len(found) == cuts
    for told in found:
        assert told["held"], told  # zero current within lease and period, and so was every sample after
        assert told["at_rest"] and told["revoked"] == 1, told
        assert told["mode"] == "TRIPPED", told
