"""The recorder alone: its share of a core, gaps, bytes a value, memory, at a rate that this host cannot run a cell at.

This process stands for plant, controller and supervisor: over the same transport it sends one sample's messages, in real frames
with sequence numbers, at the rate asked for. Their numbers are noise, which compresses less than the numbers of a machine.
Example: python bench/recorder.py --minutes 10 --rate-hz 1000
"""

import contextlib
import os
import random
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple, get_type_hints

import rig
from annotated_types import Len
from soak import growth, resident_bytes

from hydrohil.cell import processes as cells
from hydrohil.shared.contract.columns import column_names
from hydrohil.shared.contract.description import described
from hydrohil.shared.contract.messages import InboxCounts, LinkStats, PlantDescription
from hydrohil.shared.contract.topics import TOPICS, Topic
from hydrohil.shared.host.process import draw_number
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.units import NS_PER_S

LOOP_TOPICS = tuple(topic for topic in TOPICS if topic.per_sample)
POOL = 997  # different bodies of a topic; a prime, so that they meet the rate's round numbers anew
LINK_STATS_S = 1.0  # link statistics, as the services publish them
READ_S = 5.0
JOIN_S = 60.0
BYTES_PER_MB = 1 << 20
COUNTS = 4096


class Feed(NamedTuple):
    """A topic, the bus that sends it, and the bodies to send."""

    topic: Topic
    bus: Bus
    bodies: list[Any]


def noise(message: Any, rng: random.Random) -> Any:
    """A body of the right shape: measured quantities scatter, modes and flags stand still."""
    fields = []
    for name, hint in get_type_hints(message, include_extras=True).items():
        bounds = getattr(hint, "__metadata__", ())
        length = next((bound.min_length for bound in bounds if isinstance(bound, Len)), None)
        kind = float if hint is float or "float" in str(hint) else int
        fields.append(tuple(_drawn(name, kind, rng) for _ in range(length)) if length is not None else _drawn(name, kind, rng))
    return message(*fields)


def _drawn(name: str, kind: type, rng: random.Random) -> float | int:
    if kind is float:
        return rng.gauss(0.0, 1.0)
    return rng.randrange(COUNTS) if name.endswith(("_counts", "_age_ns", "compute_ns")) else 0


def numbered(body: Any, number: int, period_ns: int) -> Any:
    """The same body at another sample of the trial."""
    at = {"number": number, "tick": number, "time_ns": number * period_ns, "trial_time_ns": number * period_ns}
    return body._replace(**{name: value for name, value in (at | {"command_number": number - 1}).items() if name in body._fields})


def describe(period_ns: int) -> PlantDescription:
    """The machine that this process stands for."""
    lease_ns = 20_000_000
    return described(
        UNIMATE,
        sample_period_ns=period_ns,
        latch_ns=period_ns * 4 // 5,
        permit_ttl_ns=lease_ns,
        command_ttl_ns=lease_ns,
        gate_force_limit_n=420.0,
        force_axis=2,
        force_sign=1.0,
    )


def publish_link_stats(buses: dict[str, Bus], number: int) -> None:
    """What every service publishes once a second: counts of the messages that it receives from the others."""
    for name, bus in buses.items():
        keys = [topic.key for topic in LOOP_TOPICS if topic.publisher != name and topic.loop]
        counts = tuple(InboxCounts(key, number, *(0,) * (len(InboxCounts._fields) - 2)) for key in keys)
        bus.publish(f"{name}/link_stats", LinkStats(number, counts))


def send(feeds: list[Feed], buses: dict[str, Bus], rate_hz: float, seconds: float) -> Iterator[int]:
    """Sample after sample at the rate; yields the number of those sent; a late sample is sent at once."""
    period_ns = round(NS_PER_S / rate_hz)
    began_ns, published_ns = time.monotonic_ns(), 0
    for number in range(round(seconds * rate_hz)):
        due_ns = number * period_ns
        if (early_ns := began_ns + due_ns - time.monotonic_ns()) > 0:
            time.sleep(early_ns / NS_PER_S)
        for topic, bus, bodies in feeds:
            bus.publish(topic.key, numbered(bodies[number % POOL], number, period_ns), (number, due_ns))
        if due_ns - published_ns >= LINK_STATS_S * NS_PER_S:
            published_ns = due_ns
            publish_link_stats(buses, number)
        yield number + 1


def processor_s(pid: int) -> float:
    """Processor time of a process, all its threads."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measure(place: cells.Place, rate_hz: float, seconds: float, folder: Path, extra: list[str]) -> dict[str, Any]:
    """One recording, from `record` to `finish`."""
    started = cells.start(place, ("recorder",), with_parent=True, extra={"recorder": ["--folder", str(folder), *extra]})
    process = started["recorder"]
    try:
        with contextlib.ExitStack() as stack:
            names = dict.fromkeys(topic.publisher for topic in LOOP_TOPICS)
            buses = {name: stack.enter_context(Bus(name, place.cell, place.port, draw_number())) for name in names}
            operator = stack.enter_context(cells.operator_bus(place))
            await_recorder(operator)
            rng = random.Random(1)
            feeds = [Feed(t, buses[t.publisher], [noise(t.message, rng) for _ in range(POOL)]) for t in LOOP_TOPICS]
            buses["plant"].publish("plant/description", describe(round(NS_PER_S / rate_hz)))
            cells.ask(operator, "recorder", "record", 10.0, path="bench.rrd", title="bench")
            result = watch(process.pid, send(feeds, buses, rate_hz, seconds))
            await_recorder(operator)  # a host that is too busy may have cut the operator off meanwhile
            recorded = cells.ask(operator, "recorder", "finish", 120.0)
            return result | {"recorded": recorded, "scalars": scalars(recorded["rows_by_topic"], feeds)}
    finally:
        cells.stop([process.pid])


def await_recorder(bus: Bus) -> None:
    """Until the recorder answers and its subscriptions have come."""
    deadline = time.monotonic() + JOIN_S
    while bus.ask("recorder", "status", {}, 1.0) is None:
        if time.monotonic() > deadline:
            raise cells.CellError(f"no recorder within {JOIN_S:g} s")
        time.sleep(0.1)
    time.sleep(1.0)


def watch(pid: int, sending: Iterator[int]) -> dict[str, Any]:
    """Send all of it; what the recorder's process used meanwhile."""
    began, used, read, sent = time.monotonic(), processor_s(pid), 0.0, 0
    memory: list[tuple[float, int]] = []
    with rig.console.status("") as status:
        for sent in sending:
            now = time.monotonic() - began
            if now - read >= READ_S:
                read = now
                memory.append((now, resident_bytes(pid)))
                status.update(f"{now:.0f} s, {sent} samples, {memory[-1][1] / BYTES_PER_MB:.0f} MB")
    wall_s = time.monotonic() - began
    share = (processor_s(pid) - used) / wall_s
    return {"samples": sent, "wall_s": wall_s, "rate_hz": sent / wall_s, "core_share": share, "memory": memory}


def scalars(rows_by_topic: dict[str, int], feeds: list[Feed]) -> int:
    """Values in the recorded topics, the frames' numbers among them; the figures drawn from them are not counted."""
    return sum(rows_by_topic[f.topic.key] * (1 + len(column_names(f.bodies[0]))) for f in feeds)


def main() -> int:
    line = rig.parser(__doc__)
    line.add_argument("--minutes", type=float, default=10.0, help="of the recording (10)")
    line.add_argument("--rate-hz", type=float, default=1000.0, help="samples a second, five messages each (1000)")
    line.add_argument("--live", type=int, metavar="PORT", help="with a live view on this port")
    given = line.parse_args()
    extra = [] if given.live is None else ["--live", str(given.live)]
    with tempfile.TemporaryDirectory() as folder:
        result = measure(rig.place_of(given), given.rate_hz, given.minutes * 60.0, Path(folder), extra)
    return report(given, result)


def report(given: Any, result: dict[str, Any]) -> int:
    """Figures; 0 if nothing is missing."""
    recorded, memory = result["recorded"], growth(result["memory"])
    figures = {
        "samples a second": result["rate_hz"],
        "share of a core, %": 100.0 * result["core_share"],
        "gaps": recorded["gaps"],
        "bytes a value": recorded["bytes"] / result["scalars"],
        "bytes, MB": recorded["bytes"] / BYTES_PER_MB,
        "load average of the host": os.getloadavg()[1],
        "memory first, MB": memory["first_mb"],
        "memory last, MB": memory["last_mb"],
        "memory, second half, MB an hour": memory["mb_per_hour"],
    }
    rig.table(f"recorder at {given.rate_hz:g} Hz for {given.minutes:g} min", ("what", "figure"), list(figures.items()))
    if recorded["failure"]:
        rig.console.print(f"the recording has stopped: {recorded['failure']}")
    rig.finish(given.json, result | {"figures": figures})
    return 0 if not recorded["gaps"] and not recorded["failure"] else 1


if __name__ == "__main__":
    sys.exit(main())
