"""What the services must know of a hydraulic arm: names, units, channels, lengths, travel, and the bounds that protect it.

Three links: two turn (rad), the third slides (m); their order is (rotate, down/up with + down, out/in with + out). A suffix
`_q` means rad for the first two and m for the third. The plant sends this description, and every
other service takes the machine from it.
"""

import hashlib
from typing import Annotated, NamedTuple

import msgpack
from annotated_types import Len

LINKS = ("rotate", "down_up", "out_in")
LINK_TITLES = ("rotate", "down/up", "out/in")  # for people
LINK_UNITS = ("rad", "rad", "m")
ENCODERS = (*LINKS, "roll", "pitch")
PITCH = 3  # index of the hand's pitch where only moving encoders are counted

Triple = tuple[float, float, float]
PerLink = Annotated[Triple, Len(3, 3)]
PerEncoder = Annotated[tuple[float, float, float, float], Len(4, 4)]  # rotate, down/up, out/in, pitch

_ID_BYTES = 6  # 48 bits: exact as a float64, so that a recording holds it


class Channel(NamedTuple):
    """One converter channel: value = scale * count + offset, count in [low, high]."""

    name: str
    unit: str
    scale: float
    offset: float
    bits: int
    low: int
    high: int


class Drive(NamedTuple):
    """How a valve's current becomes a D/A code, and which current a code drives; the same for all three valves.

    c = trunc(u counts_per_a) in [min_counts, max_counts],  code = zero_code + trunc(numerator c / denominator)
    u = (code - zero_code) a_per_code
    """

    counts_per_a: float
    min_counts: int
    max_counts: int
    numerator: int
    denominator: int
    zero_code: int
    a_per_code: float


class Geometry(NamedTuple):
    """Lengths and joint travel; `hydrohil.shared.contract.pose` has the equations."""

    offset_m: float  # a2, shoulder axis to boom
    hand_m: float  # a4, wrist to tip
    retracted_m: float  # boom length at q3 = 0
    low_q: PerLink
    high_q: PerLink


class Gauge(NamedTuple):
    """The force gauge between hand and tool."""

    noise_n: float  # largest, either way
    range_n: float  # its amplifier saturates there
    stiffness_n_per_m: float  # in series with whatever it touches, so no environment pushes back stiffer
    damping_ns_per_m: float  # beside the spring
    quiet_counts: int  # readings of a gauge that works differ by more than this often enough


class MotionBounds(NamedTuple):
    """What the valves and the supply can do to the links; no experiment changes it."""

    full_speed: PerEncoder  # rad/s, out/in m/s; the fourth is the hand's pitch
    moves_down_a: PerLink  # current that moves a link towards smaller q whatever stands against it
    moves_up_a: PerLink  # the same towards greater q
    moves_within_ns: int  # by one count under such a current
    brakes_q: PerLink  # way on from full speed once such a current stands against it
    tip_count_m: float  # what encoder counts leave unknown of the tip along one axis


class MachineDescription(NamedTuple):
    """One hydraulic arm."""

    name: str  # as an experiment names it
    title: str
    encoders: tuple[Channel, ...]  # of ENCODERS
    force: Channel
    converters: tuple[Channel, ...]  # D/A of the links, as current in A
    drive: Drive
    geometry: Geometry
    gauge: Gauge
    motion: MotionBounds
    supply_low_pa: float  # what its supply may be
    supply_high_pa: float


def machine_hash(machine: MachineDescription) -> bytes:
    """SHA-256 over the MessagePack of the description, as it stands in the body of `plant/description`."""
    packed: bytes = msgpack.packb(machine)
    return hashlib.sha256(packed).digest()


def machine_id(digest: bytes) -> int:
    """The first 48 bits of a description's hash, by which a controller states every sample which machine it drives."""
    return int.from_bytes(digest[:_ID_BYTES], "big")
