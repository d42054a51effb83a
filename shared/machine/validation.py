"""Whether a machine description can be used: every number finite and in its range, every table of its length.

It comes over the wire, so nothing of it is taken for granted; what must hold is stated, so that NaN fails.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from hydrohil.shared.machine.description import ENCODERS, LINK_UNITS, LINKS, Channel, Drive, MachineDescription

MOST_CHARACTERS = 64  # of a name or unit
MOST_BITS = 32
_SAME = 1e-6  # relative: two numbers that state one thing
_LARGEST = 1e9
_SMALLEST = 1e-9


class Bound(NamedTuple):
    """One number and what it may be, ends included."""

    field: str
    value: float
    low: float
    high: float
    unit: str


def machine_problem(machine: MachineDescription) -> str:
    """What is wrong with a description, in one line that names the field; "" if nothing is."""
    if not (_is_name(machine.name) and _is_name(machine.title)):
        return f"machine.name and machine.title are expected to have 1 to {MOST_CHARACTERS} printable characters"
    return _tables_problem(machine) or _numbers_problem(machine) or _drive_problem(machine)


def _is_name(text: str) -> bool:
    return 0 < len(text) <= MOST_CHARACTERS and text.isprintable()


def _tables_problem(machine: MachineDescription) -> str:
    """The channels: as many as there are, in their order, in the units that kinematics counts in."""
    tables = (
        ("encoders", machine.encoders, ENCODERS),
        ("force", (machine.force,), ("force",)),
        ("converters", machine.converters, LINKS),
    )
    for field, channels, names in tables:
        found = tuple(channel.name for channel in channels)
        if found != names:
            shown = ", ".join(name[:MOST_CHARACTERS] for name in found[: len(names) + 1])
            return f"machine.{field}: {shown or 'none'}; expected {', '.join(names)}"
    units = (*LINK_UNITS, "count", "rad", "N", "A", "A", "A")
    for channel, unit in zip((*machine.encoders, machine.force, *machine.converters), units, strict=True):
        if channel.unit != unit:
            return f"machine: channel {channel.name} has the unit {channel.unit[:MOST_CHARACTERS]!r}; expected {unit!r}"
        if what := _channel_problem(channel):
            return f"machine: channel {channel.name}: {what}"
    return ""


def _channel_problem(channel: Channel) -> str:
    if not _SMALLEST <= abs(channel.scale) <= _LARGEST:
        return f"scale is {channel.scale:g} {channel.unit} a count; expected {_SMALLEST:g}..{_LARGEST:g}, either sign"
    if not abs(channel.offset) <= _LARGEST:
        return f"offset is {channel.offset:g} {channel.unit}; expected a finite number"
    if not 1 <= channel.bits <= MOST_BITS:
        return f"bits is {channel.bits}; expected 1..{MOST_BITS}"
    codes = 1 << channel.bits
    if not (-codes <= channel.low < channel.high < codes and channel.high - channel.low < codes):
        return f"counts go from {channel.low} to {channel.high}; expected low < high within {channel.bits} bits"
    return ""


def _numbers_problem(machine: MachineDescription) -> str:
    for bound in _bounds(machine):
        if not bound.low <= bound.value <= bound.high:
            return f"machine.{bound.field} is {bound.value:g} {bound.unit}; expected {bound.low:g}..{bound.high:g}"
    return ""


def _bounds(machine: MachineDescription) -> Iterator[Bound]:
    geometry, gauge, motion = machine.geometry, machine.gauge, machine.motion
    yield Bound("geometry.offset_m", geometry.offset_m, -100.0, 100.0, "m")
    yield Bound("geometry.hand_m", geometry.hand_m, -100.0, 100.0, "m")
    yield Bound("geometry.retracted_m", geometry.retracted_m, -100.0, 100.0, "m")
    for link, unit, low, high in zip(LINKS, LINK_UNITS, geometry.low_q, geometry.high_q, strict=True):
        largest = 10.0 if unit == "rad" else 100.0
        yield Bound(f"geometry.low_q of {link}", low, -largest, largest, unit)
        yield Bound(f"geometry.high_q of {link}", high, low + _SMALLEST, largest, unit)
    yield Bound("gauge.noise_n", gauge.noise_n, 0.0, 1e5, "N")
    yield Bound("gauge.range_n", gauge.range_n, gauge.noise_n, 1e6, "N")
    yield Bound("gauge.stiffness_n_per_m", gauge.stiffness_n_per_m, 1.0, _LARGEST, "N/m")
    yield Bound("gauge.damping_ns_per_m", gauge.damping_ns_per_m, 0.0, _LARGEST, "N s/m")
    yield Bound("gauge.quiet_counts", gauge.quiet_counts, 0, 1000, "counts")
    yield from _each("motion.full_speed", motion.full_speed, 100.0, "rad/s (out/in m/s)")
    yield from _each("motion.moves_down_a", motion.moves_down_a, 1e3, "A")
    yield from _each("motion.moves_up_a", motion.moves_up_a, 1e3, "A")
    yield from _each("motion.brakes_q", motion.brakes_q, 10.0, "rad (out/in m)")
    yield Bound("motion.moves_within_ns", motion.moves_within_ns, 1e6, 1e10, "ns")
    yield Bound("motion.tip_count_m", motion.tip_count_m, _SMALLEST, 1.0, "m")
    yield Bound("supply_low_pa", machine.supply_low_pa, 0.0, 1e8, "Pa")
    yield Bound("supply_high_pa", machine.supply_high_pa, machine.supply_low_pa, 1e8, "Pa")


def _each(field: str, values: Sequence[float], largest: float, unit: str) -> Iterator[Bound]:
    return (Bound(f"{field}[{index}]", value, _SMALLEST, largest, unit) for index, value in enumerate(values))


def _drive_problem(machine: MachineDescription) -> str:
    """The D/A: a current that is written is the current that is driven, and zero is inside every converter's range."""
    drive = machine.drive
    if not (_SMALLEST <= drive.counts_per_a <= _LARGEST and _SMALLEST <= drive.a_per_code <= _LARGEST):
        return f"machine.drive has {drive.counts_per_a:g} counts/A and {drive.a_per_code:g} A/code; expected positive numbers"
    if not (-(1 << MOST_BITS) <= drive.min_counts < 0 < drive.max_counts <= 1 << MOST_BITS):
        return f"machine.drive counts from {drive.min_counts} to {drive.max_counts}; expected a range about 0"
    if not 0 < drive.numerator <= drive.denominator <= 1 << 16:
        return f"machine.drive reduces by {drive.numerator}/{drive.denominator}; expected a share above 0, at most 1"
    driven = drive.counts_per_a * drive.numerator / drive.denominator * drive.a_per_code
    if not abs(driven - 1.0) <= _SAME:
        return f"machine.drive drives {driven:g} A for each ampere that is written; expected 1"
    return next((what for channel in machine.converters if (what := _converter_problem(channel, drive))), "")


def _converter_problem(channel: Channel, drive: Drive) -> str:
    if not channel.low < drive.zero_code < channel.high:
        return f"machine.drive.zero_code is {drive.zero_code}; expected inside {channel.low}..{channel.high} of {channel.name}"
    zero_a = channel.scale * drive.zero_code + channel.offset
    if not (abs(channel.scale / drive.a_per_code - 1.0) <= _SAME and abs(zero_a) <= _SAME * abs(channel.scale)):
        return f"machine: converter {channel.name} and machine.drive state two currents for one code; expected one"
    return ""
