"""Faults that can be injected, as one table: what breaks, where, by how much, and on which clocks it can be played.

An experiment schedules them in its section [[faults]]; `hydrohil inject` sends them to a running cell. The emulated machine
plays the faults of sensors and actuators, the bus of each receiver those of its paths, the operator those of processes.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Annotated, Any, Literal, NamedTuple

from annotated_types import Interval

from hydrohil.shared.machine.description import LINKS
from hydrohil.shared.units import NS_PER_S

Group = Literal["sensor", "actuator", "transport", "process"]

FORCE = ("force",)
ENCODERS = tuple(f"encoder_{link}" for link in LINKS)
VALVES = tuple(f"valve_{link}" for link in LINKS)
CONVERTERS = tuple(f"dac_{link}" for link in LINKS)
PATHS = ("plant>controller", "plant>supervisor", "controller>plant", "controller>supervisor", "supervisor>plant")
CUTS = ("plant-controller", "plant-supervisor", "controller-supervisor")  # both ways
PROCESSES = ("plant", "controller", "supervisor", "recorder")
COUNTED = ("counts", "messages", "processes")  # units that come whole
FOR_EVER = 2**31  # later than any tick
MOST_FAULTS = 32  # of a trial, and injected by hand in one service at once: each costs a few us a sample
MOST_DELAY_MS = 1000.0  # on one path at once: each message is compared with all that might overtake it
_EVERY, _ON_THE_BUS, _LIVE = ("local", "lockstep", "real"), ("lockstep", "real"), ("real",)
_CLOCKS: dict[Group, tuple[str, ...]] = {"sensor": _EVERY, "actuator": _EVERY, "transport": _ON_THE_BUS, "process": _LIVE}


class Fault(NamedTuple):
    """One fault of a trial; ticks at or after `at_s` and before its end have it."""

    kind: str
    target: str
    at_s: Annotated[float, Interval(ge=-10.0, le=3600.0)] = 0.0  # time of the trial; negative while the force bias is taken
    lasts_s: Annotated[float, Interval(ge=0.0, le=3600.0)] = 0.0  # 0 = to the trial's end
    value: float = 0.0  # how much; its meaning is the row's


class Row(NamedTuple):
    """What one kind of fault does to some targets."""

    kind: str
    targets: tuple[str, ...]
    group: Group
    words: str
    unit: str = ""  # of the value; "" = it takes none
    low: float = 0.0
    high: float = 0.0

    @property
    def clocks(self) -> tuple[str, ...]:
        """Clocks on which it can be played."""
        return _CLOCKS[self.group]


ROWS = (
    Row("stuck", FORCE + ENCODERS, "sensor", "the reading stays what it was"),
    Row("garbage", FORCE + ENCODERS, "sensor", "any code of the converter, another each sample"),
    Row("dropout", FORCE + ENCODERS, "sensor", "cable off: the gauge at its negative rail, a counter at 0"),
    Row("offset", FORCE, "sensor", "a jump of the reading", unit="N", low=-1000.0, high=1000.0),
    Row("offset", ENCODERS, "sensor", "a jump of the counter", unit="counts", low=-8192.0, high=8192.0),
    Row("drift", FORCE, "sensor", "the reading runs away", unit="N/s", low=-1000.0, high=1000.0),
    Row("drift", ENCODERS, "sensor", "the counter runs away", unit="counts/s", low=-8192.0, high=8192.0),
    Row("gain", FORCE, "sensor", "the reading times this", unit="times", high=10.0),
    Row("noise", FORCE, "sensor", "its own noise times this; 0 is too quiet to be true", unit="times", high=100.0),
    Row("noise", ENCODERS, "sensor", "uniform within +- this", unit="counts", high=8192.0),
    Row("wrap", ENCODERS, "sensor", "the counter passes its end: its highest bit flips"),
    Row("stuck", VALVES, "actuator", "the spool stays where it was"),
    Row("leak", VALVES, "actuator", "cross-port leakage times this", unit="times", low=1.0, high=1000.0),
    Row("stuck", CONVERTERS, "actuator", "the D/A holds its code, whatever is written"),
    Row("drop", ("supply",), "actuator", "share of the supply pressure that is lost", unit="share", high=1.0),
    Row("loss", PATHS, "transport", "each message is lost with this probability", unit="probability", high=1.0),
    Row("burst", PATHS, "transport", "so many messages in a row are lost", unit="messages", low=1.0, high=1e6),
    Row("duplicate", PATHS, "transport", "each message comes twice with this probability", unit="probability", high=1.0),
    Row("reorder", PATHS, "transport", "each message changes places with its successor", unit="probability", high=1.0),
    Row("delay", PATHS, "transport", "each message comes later by this", unit="ms", high=1000.0),
    Row("jitter", PATHS, "transport", "each message comes later by up to this", unit="ms", high=1000.0),
    Row("corrupt", PATHS, "transport", "one bit of a message flips with this probability", unit="probability", high=1.0),
    Row("partition", PATHS + CUTS, "transport", "nothing comes through, one way (a>b) or both (a-b)"),
    Row("kill", PROCESSES, "process", "SIGKILL"),
    Row("freeze", PROCESSES, "process", "SIGSTOP, thawed at the end"),
    Row("slow", PROCESSES[:3], "process", "each step takes longer by this", unit="ms", high=1000.0),
    Row("hog", ("host",), "process", "so many processes that never rest", unit="processes", low=1.0, high=64.0),
)


def row_of(fault: Fault) -> Row:
    """The row of `fault`; LookupError with one line that names what there is."""
    of_kind = [row for row in ROWS if row.kind == fault.kind]
    if not of_kind:
        kinds = ", ".join(dict.fromkeys(row.kind for row in ROWS))
        raise LookupError(f"kind is {fault.kind!r}, expected one of {kinds}")
    for row in of_kind:
        if fault.target in row.targets:
            return row
    targets = ", ".join(target for row in of_kind for target in row.targets)
    raise LookupError(f"target of {fault.kind} is {fault.target!r}, expected one of {targets}")


def problem(fault: Fault, clock: str = "") -> str:
    """Why `fault` cannot be played (on `clock`, if one is named), one line; "" if it can. Nothing is accepted and ignored."""
    try:
        row = row_of(fault)
    except LookupError as error:
        return str(error.args[0])
    if clock and clock not in row.clocks:
        return f"{fault.kind} of {fault.target} cannot be played on the {clock} clock, only on {' or '.join(row.clocks)}"
    if not row.unit and fault.value != 0.0:
        return f"value of {fault.kind} is {fault.value:g}, but it takes none: leave it out"
    if row.unit and not (math.isfinite(fault.value) and row.low <= fault.value <= row.high):
        return f"value of {fault.kind} is {fault.value:g} {row.unit}, expected {row.low:g}..{row.high:g}"
    if row.unit in COUNTED and fault.value != int(fault.value):
        return f"value of {fault.kind} is {fault.value:g}, expected a whole number of {row.unit}"
    if fault.kind == "kill" and fault.lasts_s != 0.0:
        return f"lasts_s of kill is {fault.lasts_s:g} s, but what is killed stays so: leave it out"
    if fault.kind == "burst" and fault.lasts_s != 0.0:
        return f"lasts_s of burst is {fault.lasts_s:g} s, but it ends with its last message: leave it out"
    return ""


def ticks_of(fault: Fault, period_ns: int) -> tuple[int, int]:
    """First tick of `fault` and the tick after its last, by the nominal period: the same on every clock, at least one tick."""
    first = -(-round(fault.at_s * NS_PER_S) // period_ns)
    if fault.lasts_s == 0.0:
        return first, FOR_EVER
    end = -(-round((fault.at_s + fault.lasts_s) * NS_PER_S) // period_ns)
    return first, max(first + 1, end)


def value_missing(fault: Fault) -> str:
    """That the value is missing and what is expected, one line; "" if this fault takes none, or is not known."""
    try:
        row = row_of(fault)
    except LookupError:
        return ""
    return f"value of {row.kind} is missing, expected {row.low:g}..{row.high:g} {row.unit}" if row.unit else ""


def has_value(written: Any) -> bool:
    """Whether a fault as it was written, before its defaults, says how much."""
    return "value" in written if isinstance(written, dict) else len(written) > Fault._fields.index("value")


def delay_ms(faults: Iterable[Fault], path: str) -> float:
    """By how much these may make a message on `path` later, together."""
    return sum(fault.value for fault in faults if fault.kind in ("delay", "jitter") and fault.target == path)


def too_late(faults: Sequence[Fault]) -> str:
    """Where and when a trial's delays add up to more than is played, one line; "" nowhere."""
    for begun in faults:
        at_s, path = begun.at_s, begun.target
        acting = [f for f in faults if f.at_s <= at_s and (f.lasts_s == 0.0 or at_s < f.at_s + f.lasts_s)]
        if (together := delay_ms(acting, path)) > MOST_DELAY_MS:
            return f"delay and jitter of {path} add up to {together:g} ms at {at_s:g} s, expected at most {MOST_DELAY_MS:g} ms"
    return ""


def never_acts(fault: Fault, period_ns: int, ticks: tuple[int, int]) -> str:
    """Why `fault` would not act in a trial of these ticks (first, and the one after its last), one line; "" if it would."""
    first, end = ticks_of(fault, period_ns)
    begin_s, end_s = (tick * period_ns / NS_PER_S for tick in ticks)
    if first >= ticks[1]:
        begins = f"{fault.kind} of {fault.target} begins at {fault.at_s:g} s"
        return f"{begins}, but the trial ends at {end_s:g} s: let it begin earlier, or lengthen the trial"
    if end <= ticks[0]:
        ends = f"{fault.kind} of {fault.target} is over at {fault.at_s + fault.lasts_s:g} s"
        return f"{ends}, but the trial begins at {begin_s:g} s: let it last longer, or begin later"
    return ""


def trial_problems(
    written: Sequence[Any], faults: Sequence[Fault], period_ns: int, ticks: tuple[int, int], clock: str = ""
) -> list[str]:
    """What is wrong with a trial's faults, a line each that names the fault's place; `written` is what they were read from."""
    found = []
    if len(faults) > MOST_FAULTS:
        found.append(f"faults has {len(faults)} entries, expected at most {MOST_FAULTS}: leave some out")
    if what := too_late(faults):
        found.append(f"faults: {what}")
    for number, (plain, fault) in enumerate(zip(written, faults, strict=True)):
        missing = "" if has_value(plain) else value_missing(fault)
        if what := missing or problem(fault, clock) or never_acts(fault, period_ns, ticks):
            found.append(f"faults.{number}: {what}")
    return found


def words(fault: Fault) -> str:
    """What a trial schedules, for people."""
    amount = f" {fault.value:g} {row_of(fault).unit}" if row_of(fault).unit else ""
    ends = f"for {fault.lasts_s:g} s" if fault.lasts_s else "to the end"
    return f"{fault.kind} {fault.target}{amount} at {fault.at_s:g} s {ends}"


def of_group(faults: tuple[Fault, ...], *groups: Group) -> tuple[Fault, ...]:
    """Those of `faults` that a service of these groups plays; all must be valid."""
    return tuple(fault for fault in faults if row_of(fault).group in groups)
