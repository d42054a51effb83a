"""A cell in a network namespace of its own, where links are cut for real: the kernel drops their packets, one way or both.

Run in `unshare -rn` with a service, or several with commas between, whose links to the plant are cut: prints, as JSON, what
plant and supervisor say after the cut and after it has healed.
"""

import json
import re
import subprocess
import sys
import time
from typing import Any

from hydrohil.cell import processes as cells
from hydrohil.cell.session import arm, load
from hydrohil.shared.contract.topics import SERVICES
from hydrohil.shared.transport.bus import Bus
from tests.support.live_cell import ZERO, experiment, own_place, until

LEASE = {"plant": ["--permit-ttl-ms", "200", "--no-realtime"]}
CUT_S, HEALED_S = 1.0, 1.0


def network(*words: str) -> str:
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def loopback() -> None:
    """Up, and its addresses looked up after the rules that cut."""
    network("ip", "link", "set", "lo", "up")
    network("ip", "rule", "add", "pref", "100", "lookup", "local")
    network("ip", "rule", "del", "pref", "0")


def caller_port(caller: int, listening: int) -> int:
    """Port from which process `caller` holds its link to the port of the other; the recorder's link may come late."""
    link = rf"127\.0\.0\.1:(\d+)\s+127\.0\.0\.1:{listening}\s.*pid={caller},"
    found = until(lambda: re.findall(link, network("ss", "-tnpH")), f"a link of process {caller}")
    return int(found[0])


def rules(verb: str, ways: str, port: int) -> None:
    """Drop ("add") or let pass ("del") what the caller sends ("to"), what is sent to it ("from"), or "both"."""
    for way, side in (("to", "sport"), ("from", "dport")):
        if ways in (way, "both"):
            network("ip", "rule", verb, "pref", "5", "ipproto", "tcp", side, str(port), "blackhole")


def state(bus: Bus) -> dict[str, Any]:
    found = cells.statuses(bus, ("plant", "supervisor"))
    plant = found["plant"]
    return {"at_rest": plant["dac_counts"] == ZERO, "last_cut": plant["last_cut"], "mode": found["supervisor"]["mode"]}


def main(services: str, ways: str) -> None:
    loopback()
    place = own_place()
    started = cells.start(place, SERVICES, with_parent=True, extra=LEASE)
    try:
        with cells.operator_bus(place) as bus:
            cells.await_ready(place, bus, started)
            ports = [caller_port(started[service].pid, place.port) for service in services.split(",")]
            load(bus, experiment(30.0), 1, "real", unqualified=True)
            arm(bus)
            cells.ask(bus, "supervisor", "start")
            until(lambda: not state(bus)["at_rest"], "the valves move")
            for port in ports:
                rules("add", ways, port)
            time.sleep(CUT_S)
            during = state(bus)
            for port in ports:
                rules("del", ways, port)
            time.sleep(HEALED_S)
            print(json.dumps({"during": during, "after": state(bus)}))
    finally:
        cells.stop(process.pid for process in started.values())


if __name__ == "__main__":
    main(*sys.argv[1:])
