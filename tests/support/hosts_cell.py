"""A cell whose services are on hosts of their own: a network namespace each, cables to one switch, and `--hosts`.

Run in `unshare -rn`: pulls a cable, or drops what one host sends another, while the valves move; mends it, and prints a line of
JSON for each. The namespaces end with the services in them, so that nothing is left, however this ends.
"""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from hydrohil.cell import processes as cells
from hydrohil.cell.session import arm, load
from hydrohil.faulttest.observer import Observer
from hydrohil.faulttest.processes import period_s
from hydrohil.faulttest.router import cut_of, judged_by_cut
from hydrohil.shared.host.child import environment, python_module
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.endpoints import Network
from tests.support.live_cell import ZERO, experiment, own_place, until

SWITCH = "192.0.2.1"  # of the network that RFC 5737 keeps for examples; also the operator's
HOSTS = {"plant": "192.0.2.2", "controller": "192.0.2.3", "supervisor": "192.0.2.4"}
OPTIONS = {"plant": ["--permit-ttl-ms", "200"]}
WAITS = 'read go && exec "$@"'  # in its namespace, until that has an address; ends with the process that would send "go"
TRIAL_S, CUT_S, WATCHED_S = 30.0, 1.0, 1.0


class Cut(NamedTuple):
    """Where and how a network breaks, and is mended."""

    words: str
    cut: Callable[[], object]
    mend: Callable[[], object]


def ip(*words: str, host: int = 0) -> None:
    """`ip ...`, in the namespace of process `host`."""
    inside = ["nsenter", "-t", str(host), "-n"] if host else []
    subprocess.run([*inside, "ip", *words], check=True)


def switch() -> None:
    ip("link", "set", "lo", "up")
    ip("link", "add", "switch", "type", "bridge")
    ip("addr", "add", f"{SWITCH}/24", "dev", "switch")
    ip("link", "set", "switch", "up")


def plugged_in(service: str, pid: int) -> None:
    """A cable from the switch to that process's namespace."""
    until(lambda: os.readlink(f"/proc/{pid}/ns/net") != os.readlink("/proc/self/ns/net"), "a namespace")
    ip("link", "add", service, "type", "veth", "peer", "name", "eth0", "netns", str(pid))
    ip("link", "set", service, "master", "switch", "up")
    ip("link", "set", "lo", "up", host=pid)
    ip("addr", "add", f"{HOSTS[service]}/24", "dev", "eth0", host=pid)
    ip("link", "set", "eth0", "up", host=pid)


def started(place: cells.Place, service: str) -> "subprocess.Popen[bytes]":
    """A service on its host."""
    line = ["unshare", "-n", "sh", "-c", WAITS, "sh", *python_module(f"hydrohil.services.{service}"), *place.words]
    line += ["--no-realtime", "--with-parent", str(os.getpid()), *OPTIONS.get(service, [])]
    place.folder.mkdir(parents=True, exist_ok=True)
    with Path(place.folder / f"{service}.log").open("wb") as log:
        process = subprocess.Popen(line, env=environment(), stdin=subprocess.PIPE, stdout=log, stderr=subprocess.STDOUT)
    plugged_in(service, process.pid)
    assert process.stdin is not None
    process.stdin.write(b"go\n")
    process.stdin.close()
    return process


def cable(service: str) -> Cut:
    """Both ways: to everybody."""
    return Cut("cable", lambda: ip("link", "set", service, "down"), lambda: ip("link", "set", service, "up"))


def one_way(words: str, sender: int, receiver: str) -> Cut:
    """What one host sends another is dropped."""
    route = ("blackhole", f"{HOSTS[receiver]}/32")
    return Cut(words, lambda: ip("route", "add", *route, host=sender), lambda: ip("route", "del", *route, host=sender))


def cuts(service: str, processes: cells.Processes) -> list[Cut]:
    if service == "plant":
        return [cable(service)]
    there, back = processes[service].pid, processes["plant"].pid
    return [cable(service), one_way("to the plant", there, "plant"), one_way("from the plant", back, service)]


def tried(bus: Bus, observer: Observer, cut: Cut) -> dict[str, Any]:
    """One cut while the valves move: the reaction, and the state afterwards."""
    swing = experiment(TRIAL_S)
    load(bus, swing, 1, "real")
    arm(bus)
    observer.clear()
    cells.ask(bus, "supervisor", "start")
    until(lambda: observer.listen().samples[-1:] and observer.observed.samples[-1].body.tick > 50, "the trial")
    until(lambda: observer.listen().samples[-1].body.dac_counts != ZERO, "the valves move")
    plant = cells.ask(bus, "plant", "status")
    cut.cut()
    fault_ns = time.monotonic_ns()
    observer.listen_for(CUT_S)
    cut.mend()
    until(lambda: len(cells.statuses(bus, cells.LOOP)) == len(cells.LOOP), "everyone answers")
    observed = observer.listen_for(WATCHED_S)
    after = cells.statuses(bus, cells.LOOP)
    trial = judged_by_cut(observed, fault_ns, cut_of(after["plant"]), plant["lease_ms"] / 1e3 + period_s(swing))
    return {
        "cut": cut.words,
        "held": trial.held,
        "words": trial.words,
        "reaction_s": trial.reaction_s - trial.stalled_s,
        "at_rest": after["plant"]["dac_counts"] == ZERO,
        "revoked": after["plant"]["revoked_arming_ids"] - plant["revoked_arming_ids"],
        "last_cut": after["plant"]["last_cut"],
        "mode": after["supervisor"]["mode"],
    }


def reset(bus: Bus) -> None:
    """Ready for the next cut: only a reset does that."""

    def reset() -> bool:
        answers = [bus.ask(service, verb, {}, 1.0) for service, verb in RESET]
        return all(answer is not None and answer.accepted for answer in answers[1:])

    until(reset, "a reset is accepted")


RESET = (("supervisor", "stop"), ("plant", "reset"), ("supervisor", "reset"))


def main(service: str) -> None:
    switch()
    place = own_place()._replace(network=Network(tuple(HOSTS.items())))
    processes: cells.Processes = {}
    try:
        for name in cells.LOOP:
            processes[name] = started(place, name)
        with cells.operator_bus(place) as bus:
            cells.await_ready(place, bus, processes)
            observer = Observer(bus)
            for cut in cuts(service, processes):
                print(json.dumps(tried(bus, observer, cut)), flush=True)
                reset(bus)
    finally:
        cells.stop(process.pid for process in processes.values())


if __name__ == "__main__":
    main(sys.argv[1])
