"""A partition for real, in network namespaces where the machine allows them: pytest -m slow tests/live/test_namespaces.py -rs."""

import json
import shutil
import subprocess

import pytest

from tests.support.children import support_environment, support_module

TRIED = "ip link set lo up && ip rule add pref 5 ipproto tcp sport 1 blackhole"


def impossible() -> str:
    """Why this machine cannot cut a link for real; "" if it can."""
    missing = [tool for tool in ("unshare", "ip", "ss") if shutil.which(tool) is None]
    if missing:
        return f"a partition for real is skipped: this machine has no {', no '.join(missing)}"
    tried = subprocess.run(["unshare", "-rn", "sh", "-c", TRIED], capture_output=True, text=True, check=False)
    return f"a partition for real is skipped: {tried.stderr.strip()}" if tried.returncode else ""


REASON = impossible()
pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.skipif(bool(REASON), reason=REASON or "possible")]


def cut(services: str, ways: str):
    """What plant and supervisor say after the cut of these services' links to the plant, and after it has healed."""
    line = ["unshare", "-rn", *support_module("tests.support.namespace_cell"), services, ways]
    run = subprocess.run(line, capture_output=True, text=True, check=False, env=support_environment(), timeout=180)
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout.splitlines()[-1])


@pytest.mark.parametrize("ways", ["to", "from", "both"])
def test_a_plant_whose_links_to_all_services_are_cut_still_answers_its_operator(ways: str):
    found = cut("controller,supervisor,recorder", ways)  # a dead link holds a thread of the transport until it is closed
    assert found["during"]["at_rest"] and found["after"]["at_rest"]


@pytest.mark.parametrize("ways", ["to", "from", "both"])
@pytest.mark.parametrize("service", ["controller", "supervisor"])
def test_a_link_that_is_cut_for_real_leaves_the_valves_at_zero_and_nothing_resumes(service: str, ways: str):
    found = cut(service, ways)
    lost = ("PERMIT_STALE", "NO_PERMIT") if service == "supervisor" else ("COMMAND_STALE",)  # it may trip before its lease ends
    assert found["during"]["at_rest"] and found["after"]["at_rest"]
    assert found["during"]["last_cut"] in lost
    assert found["after"]["mode"] in ("TRIPPED", "DISARMED")
