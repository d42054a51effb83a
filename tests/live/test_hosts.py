"""A cell across hosts: a namespace for each service, a cable pulled for real: pytest -m slow tests/live/test_hosts.py -rs."""

import json
import shutil
import subprocess

import pytest

from tests.support.children import support_environment, support_module

TRIED = (
    "ip link set lo up && ip link add switch type bridge && unshare -n true && "
    "ip link add one type veth peer name two && ip route add blackhole 192.0.2.9/32 && nsenter -t $$ -n true"
)


def impossible() -> str:
    """Why this machine cannot make hosts of its own; "" if it does."""
    missing = [tool for tool in ("unshare", "nsenter", "ip") if shutil.which(tool) is None]
    if missing:
        return f"a cell across hosts is skipped: this machine has no {', no '.join(missing)}"
    tried = subprocess.run(["unshare", "-rn", "sh", "-c", TRIED], capture_output=True, text=True, check=False)
    return f"a cell across hosts is skipped: {tried.stderr.strip()}" if tried.returncode else ""


REASON = impossible()
pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.skipif(bool(REASON), reason=REASON or "possible")]


@pytest.mark.parametrize(("service", "cuts"), [("controller", 3), ("supervisor", 3), ("plant", 1)])
def test_a_host_whose_cable_is_pulled_leaves_the_valves_at_zero_and_nothing_resumes(service: str, cuts: int):
    line = ["unshare", "-rn", *support_module("tests.support.hosts_cell"), service]
    run = subprocess.run(line, capture_output=True, text=True, check=False, env=support_environment(), timeout=240)
    assert run.returncode == 0, run.stdout + run.stderr
    found = [json.loads(line) for line in run.stdout.splitlines()]
    assert len(found) == cuts
    for line in found:
        assert line["held"], line  # zero current within lease and period, and so was every sample after
        assert line["at_rest"] and line["revoked"] == 1, line
        assert line["mode"] == "TRIPPED", line
