"""Kill or freeze a service while the valves move: how long until the D/A is at zero, and does anything move again?

Bound: one lease and one sample period. An observer on the network stamps the plant's samples on the monotonic clock when
they arrive, so every figure includes the sample's way to it and up to one period of waiting for that sample; the way is
measured as half a request's round trip. A frozen plant reports nothing: its D/A falls to zero by the output watchdog after
one lease, so here the first samples after thawing are judged: codes zero, arming burned, and simulated time went on by no
more than the samples between; how far the joints ran on while the spools closed is told beside it.

Example: python bench/faults.py --trials 20 --json faults.json
"""

import itertools
import os
import random
import signal
import sys
import time
from typing import Any, NamedTuple

import rig

from experiments.experiment import Experiment
from experiments.library import find
from experiments.overrides import with_overrides
from services.operator import cell as cells
from services.operator.session import arm, load
from shared.bus import Bus, Inbox
from shared.converters import ZERO_CODE
from shared.messages import GateCause, GateState

LONG_S = 60.0
WATCHED_S = 3.0
FROZEN_S = 1.0
PATIENCE_S = 5.0
RETRIES = 3
RING = 4096
KEPT = 200  # samples before the fault
OBSERVER_PRIORITY = 60  # above the services: it works for microseconds a sample
ZERO = (ZERO_CODE,) * 3
FAULTS = (
    ("controller", "SIGKILL"),
    ("supervisor", "SIGKILL"),
    ("controller", "SIGSTOP"),
    ("supervisor", "SIGSTOP"),
    ("plant", "SIGSTOP"),
)
LONGEST_INTERVAL_MS = 5.0  # of the sampling: 4.5 ms and its jitter


class Told(NamedTuple):
    """One sample at the observer."""

    arrival_ns: int
    tick: int
    number: int
    time_ns: int
    codes: tuple[int, ...]
    gate: int
    encoders: tuple[int, ...]


class Rig(NamedTuple):
    """A cell, its processes, and the observer's rings."""

    place: cells.Place
    extra: dict[str, list[str]]
    bus: Bus
    processes: cells.Processes
    samples: Inbox


def told(samples: Inbox) -> list[Told]:
    """What has arrived."""
    bodies = [(message.arrival_ns, message.body) for message in samples.take()]
    return [
        Told(at, body.tick, body.number, body.time_ns, body.dac_counts, body.gate, body.encoder_counts) for at, body in bodies
    ]


def safe(sample: Told) -> bool:
    """Zero current behind a gate that is not open."""
    return sample.codes == ZERO and sample.gate != GateState.OPEN


def swing() -> Experiment:
    """The up/down link swings without end, so that the valves are never at rest."""
    return with_overrides(
        find("fig-4-25"),
        [
            f"duration_s={LONG_S}",
            "plant.bias_s=0.5",
            "claims=[]",
            f"reference.0.duration_s={LONG_S}",
            "reference.0.amount=0.1",
            "reference.0.amount_end=0.1",
            "reference.0.frequency_hz=0.5",
        ],
    )


def moving(rig_: Rig, experiment: Experiment, seed: int) -> list[Told]:
    """Start a trial and return while its valves move, at a random phase; the samples of the last half second or more."""
    cells.ask(rig_.bus, "supervisor", "reset")
    cells.ask(rig_.bus, "plant", "reset")
    load(rig_.bus, experiment, seed, "real")
    arm(rig_.bus)
    cells.ask(rig_.bus, "supervisor", "start")
    until = time.monotonic() + experiment.plant.bias_s + 0.5 + random.uniform(0.5, 2.5)
    last: list[Told] = []
    while time.monotonic() < until or not last or last[-1].codes == ZERO:
        time.sleep(0.001)
        last = (last + told(rig_.samples))[-KEPT:]
        if time.monotonic() > until + PATIENCE_S:
            found = cells.statuses(rig_.bus, ("plant", "supervisor"))
            raise cells.CellError(
                f"the valves do not move: {found['supervisor']['words']}; last cut {found['plant']['last_cut']}"
            )
    time.sleep(random.uniform(0.0, 0.0045))  # any phase of the sample period
    return last + told(rig_.samples)


def begin(rig_: Rig, experiment: Experiment, seed: int) -> list[Told]:
    """A moving trial; one that ends by itself before the fault (a host's stall) is said and begun again."""
    for _ in range(RETRIES):
        try:
            return moving(rig_, experiment, seed)
        except cells.CellError as error:
            rig.console.print(f"begun again: {error}")
    return moving(rig_, experiment, seed)


def first_safe(rig_: Rig, since_ns: int) -> tuple[int, int, list[Told]]:
    """Arrival of the first safe sample after an instant (0: none), unsafe ones between, and all samples from then on."""
    seen: list[Told] = []
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        time.sleep(0.001)
        seen += told(rig_.samples)
        for number, sample in enumerate(seen):
            if sample.arrival_ns >= since_ns and safe(sample):
                between = sum(earlier.arrival_ns >= since_ns for earlier in seen[:number])
                return sample.arrival_ns, between, seen[number:]
    return 0, len(seen), seen


def quiet(rig_: Rig, already: list[Told]) -> int:
    """Unsafe samples in the three seconds after a thaw (and before it, once safe)."""
    time.sleep(WATCHED_S)
    return sum(not safe(sample) for sample in already + told(rig_.samples))


def trial(rig_: Rig, experiment: Experiment, seed: int, fault: tuple[str, str]) -> dict[str, Any]:
    """One fault in one trial; the cell is whole again afterwards."""
    service, name = fault
    before = begin(rig_, experiment, seed)
    plant = cells.statuses(rig_.bus, ("plant",))["plant"]  # while armed the lease does not change
    burned, lease_ms = int(plant["burned_armings"]), float(plant["lease_ms"])
    period_ms = experiment.plant.sample_period_substeps * 0.05
    victim = rig_.processes[service]
    struck_ns = time.monotonic_ns()
    victim.send_signal(signal.Signals[name])
    result: dict[str, Any] = {"service": service, "signal": name, "codes": list(before[-1].codes)}
    result |= {"lease_ms": lease_ms, "bound_ms": lease_ms + period_ms}
    if service == "plant":
        result |= thaw_plant(rig_, before, burned)
    else:
        at_ns, _, after = first_safe(rig_, struck_ns)
        result["zero_ms"] = (at_ns - struck_ns) / 1e6 if at_ns else None
        if name == "SIGSTOP":
            time.sleep(FROZEN_S)
            victim.send_signal(signal.SIGCONT)
        result["unsafe_afterwards"] = quiet(rig_, after)
    if name == "SIGKILL":
        victim.wait()
        rig_.processes.update(cells.start(rig_.place, (service,), with_parent=True, extra=rig_.extra))
    cells.await_ready(rig_.place, rig_.bus, rig_.processes)
    return result


def thaw_plant(rig_: Rig, before: list[Told], burned: int) -> dict[str, Any]:
    """A freeze is under way: drain what was sent before it, thaw, look at what the plant says first.

    Simulated time stood still. Samples sent while the links of the transport come back are lost to the observer.
    """
    time.sleep(FROZEN_S)
    before += told(rig_.samples)
    steps = [step(a, b) for a, b in itertools.pairwise(before)]
    thawed_ns = time.monotonic_ns()
    rig_.processes["plant"].send_signal(signal.SIGCONT)
    at_ns, between, after = first_safe(rig_, thawed_ns)
    unsafe = between + quiet(rig_, after)
    plant = cells.statuses(rig_.bus, ("plant",))["plant"]
    return {
        "thaw_ms": (at_ns - thawed_ns) / 1e6 if at_ns else None,
        "moved_counts": step(before[-1], after[0]) if at_ns else None,
        "samples_between": after[0].number - before[-1].number if at_ns else None,
        "simulated_ms": (after[0].time_ns - before[-1].time_ns) / 1e6 if at_ns else None,
        "one_period_counts": max(steps, default=0),
        "burned": plant["last_cut"] == GateCause.OVERSLEPT.name and plant["burned_armings"] > burned,
        "unsafe_afterwards": unsafe,
    }


def step(before: Told, after: Told) -> int:
    """Largest motion of a link between two samples, in encoder counts."""
    return max(abs(a - b) for a, b in zip(before.encoders, after.encoders, strict=True))


def observe_promptly() -> bool:
    """Real-time scheduling for every thread of the observer, none for what it starts; False if the host refuses."""
    try:
        for thread in os.listdir("/proc/self/task"):
            os.sched_setscheduler(int(thread), os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(OBSERVER_PRIORITY))
    except OSError:
        return False
    return True


def way_us(bus: Bus) -> list[float]:
    """Half the round trip of a request to the supervisor: what the network and the observer add."""
    taken = []
    for _ in range(50):
        began = time.perf_counter_ns()
        bus.ask("supervisor", "status", {})
        taken.append((time.perf_counter_ns() - began) / 2000)
    return taken


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--trials", type=int, default=20, help="of each fault (20)")
    line.add_argument("--permit-ttl-ms", type=float, help="lease (chosen by the plant)")
    line.add_argument("--no-realtime", action="store_true", help="normal scheduling")
    line.add_argument("--only", help="one service")
    given = line.parse_args()
    extra = rig.services_options(realtime=not given.no_realtime, permit_ttl_ms=given.permit_ttl_ms)
    experiment, place, results = swing(), rig.place_of(given), []
    with rig.running(place, extra) as (bus, processes):
        prompt = observe_promptly()
        made = Rig(place, extra, bus, processes, bus.subscribe("plant/sample", RING))
        way = rig.spread(way_us(bus))
        for fault in FAULTS:
            for number in range(given.trials if given.only in (None, fault[0]) else 0):
                with rig.console.status(f"{fault[1]} of the {fault[0]}: {number + 1} of {given.trials}"):
                    result = trial(made, experiment, number, fault)
                results.append(result)
                rig.console.print(words(result))
    if not prompt:
        rig.console.print("the observer has no real-time scheduling: its own lateness is in the figures")
    return report(given, results, way)


def words(result: dict[str, Any]) -> str:
    """One trial in one line."""
    name = f"{result['signal']} {result['service']:10}"
    if "zero_ms" in result:
        taken = (
            "NEVER ZERO"
            if result["zero_ms"] is None
            else f"zero after {result['zero_ms']:.1f} ms = {result['zero_ms'] / result['lease_ms']:.2f} leases"
        )
        return f"{name} {taken}, bound {result['bound_ms']:.1f} ms; unsafe samples afterwards: {result['unsafe_afterwards']}"
    return (
        f"{name} first safe sample {result['thaw_ms']} ms after thawing; simulated time went on by {result['simulated_ms']} "
        f"ms in {result['samples_between']} samples, joints by {result['moved_counts']} counts (in one period before: "
        f"{result['one_period_counts']}); "
        f"burned {result['burned']}; unsafe samples afterwards: {result['unsafe_afterwards']}"
    )


def holds(result: dict[str, Any]) -> bool:
    """Whether the trial kept its bound and stayed safe."""
    if result["unsafe_afterwards"]:
        return False
    if "zero_ms" in result:
        return result["zero_ms"] is not None and result["zero_ms"] <= result["bound_ms"]
    samples, simulated_ms = result["samples_between"], result["simulated_ms"]
    return samples is not None and simulated_ms <= samples * LONGEST_INTERVAL_MS and bool(result["burned"])


def report(given: Any, results: list[dict[str, Any]], way: dict[str, float]) -> int:
    """Tables, file, exit status."""
    rows = []
    for service, name in FAULTS:
        these = [r for r in results if (r["service"], r["signal"]) == (service, name)]
        times = [r.get("zero_ms", r.get("thaw_ms")) for r in these]
        known = [value for value in times if value is not None]
        leases = [value / r["lease_ms"] for r, value in zip(these, times, strict=True) if value is not None]
        if these:
            bound = these[0]["bound_ms"] if service != "plant" else "after thawing"
            middle, worst = rig.percentile(known, 0.5), max(known, default=float("nan"))
            rows.append(
                (service, name, len(these), middle, worst, max(leases, default=float("nan")), bound, sum(map(holds, these)))
            )
    rig.table(
        "until the D/A is at zero",
        ("service", "signal", "trials", "median ms", "worst ms", "worst leases", "bound ms", "held"),
        rows,
    )
    rig.console.print(f"the observer's way adds up to {way['p50']:.0f} us (median), {way['max']:.0f} us (worst)")
    rig.finish(given.json, {"trials": results, "observer_way_us": way})
    return 0 if all(map(holds, results)) else 1


if __name__ == "__main__":
    sys.exit(main())
