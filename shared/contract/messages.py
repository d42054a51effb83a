"""The messages between the services. One NamedTuple a topic; its fields, in order, are the body on the wire.

Counts are what converters read and write: encoder counters, signed A/D counts, D/A codes. Everything else is SI.
`q` and `qd` are joint positions and velocities in rad and rad/s, of link 3 in m and m/s; link order is (rotate, down/up with +
down, out/in with + out).
A `tick` counts the samples of a trial: the force bias is taken at negative ticks, the reference starts at tick 0.
"""

from enum import IntEnum
from typing import Annotated, NamedTuple

from annotated_types import Len

from hydrohil.shared.machine.description import MachineDescription

NO_TRIAL = -(2**31)  # tick of a sample that belongs to no trial
NO_COMMAND = -1  # sample number that no command answers

Counts = tuple[int, ...]
Floats = tuple[float, ...]
Links = Annotated[Floats, Len(3, 3)]  # one value a link, or a point (x, y, z)
LinkCounts = Annotated[Counts, Len(3, 3)]
EncoderCounts = Annotated[Counts, Len(5, 5)]


class GateState(IntEnum):
    """What the gate in front of the D/A is doing."""

    SHUT = 0
    OPEN = 1
    REVOKED = 2  # shut by a cut: never opens again on this arming
    RECOVERING = 3  # only the unloading sign, at low current


class GateCause(IntEnum):
    """Why the gate is not open: the first condition that does not hold."""

    NONE = 0
    NO_PERMIT = 1
    NOT_RUNNING = 2
    REVOKED_ARMING = 3
    PERMIT_STALE = 4
    NO_COMMAND = 5
    COMMAND_STALE = 6
    OTHER_ARMING = 7
    EPOCH_CHANGED = 8
    IMPOSSIBLE_ECHO = 9
    OUT_OF_RANGE = 10
    BEYOND_SLEW = 11
    FORCE_INVALID = 12
    FORCE_ABOVE_LIMIT = 13
    NOT_UNLOADING = 14
    ESTOP = 15
    OVERRUN = 16
    LINK_FAULTS = 17  # more than one CRC or sequence fault a second under a bound identity
    TWO_PUBLISHERS = 18


class Mode(IntEnum):
    """Mode of the supervisor, as every permit states it."""

    DISARMED = 0
    ARMED = 1  # an arming id exists; valves shut until the trial's tick 0
    RUNNING = 2
    TRIPPED = 3
    RECOVER = 4


class TripCause(IntEnum):
    """Why the supervisor tripped; most severe first."""

    NONE = 0
    ESTOP = 1
    FORCE_INVALID = 2
    FORCE_RAW = 3
    FORCE_TARED = 4
    FORCE_FROZEN = 5
    FORCE_JUMP = 6
    FORCE_RATE = 7
    FORCE_HELD = 8
    FORCE_ENERGY = 9
    FORCE_DRIFT = 10
    FORCE_BELOW_BIAS = 11
    BIAS = 12
    ENCODER_INVALID = 13
    ENCODER_JUMP = 14
    MOTION_AGAINST = 15
    NO_MOTION = 16
    JOINT_LIMIT = 17
    WORKSPACE = 18
    JOINT_SPEED = 19
    TIP_SPEED = 20
    SAMPLE_LOST = 21
    SAMPLE_STALE = 22
    LINK_FAULTS = 23
    TWO_PUBLISHERS = 24
    OTHER_RUN = 25
    COMMAND_STALE = 26
    CONTROLLER_SILENT = 27
    QUALITY = 28
    GATE_CUT = 29
    NOT_READY = 30


class PlantDescription(NamedTuple):
    """The machine that the plant drives, and how it is sampled; all other services take both from here."""

    machine: MachineDescription
    machine_hash: bytes  # SHA-256 of `machine`; a service that uses another machine is not armed
    sample_period_ns: int
    latch_ns: int
    permit_ttl_ns: int
    command_ttl_ns: int
    gate_force_limit_n: float
    force_axis: int  # 0 = x, 2 = z: the direction in which the gauge is mounted
    force_sign: float  # direction of the environment's push on the tool along that axis


class Sample(NamedTuple):
    """What the DAQ reads at one instant, and the state of its gate and command."""

    number: int
    time_ns: int  # simulated time since the plant's start
    tick: int
    trial_time_ns: int  # simulated time since tick 0
    encoder_counts: EncoderCounts  # rotate, down/up, out/in, roll, pitch
    force_counts: int
    dac_counts: LinkCounts  # as the gate has written them, in force at this instant; a converter that is stuck drives others
    gate: int
    gate_cause: int
    gate_open_samples: int  # samples since the gate opened
    recover_signs: LinkCounts  # what RECOVERING allows
    command_number: int  # sample that the command in force answers
    command_late_substeps: int  # 0 = it took effect at the latch
    command_age_ns: int  # age of that sample when the gate accepted the command (wall clock in `real`)


class GroundTruth(NamedTuple):
    """What only an emulator knows. No controller reads it."""

    number: int
    tick: int
    q: Links
    qd: Links
    pressure_a_pa: Links
    pressure_b_pa: Links
    spool_a: Links  # spool position as current
    sticking: LinkCounts  # 1 = static friction holds the link
    tip_m: Links
    contact_force_n: float
    environment_m: float  # displacement of plate or crate


class GateEvent(NamedTuple):
    """A decision of the gate that was not "accepted"."""

    number: int
    tick: int
    state: int
    cause: int
    permit_age_ns: int  # of the samples that permit and command name, on the plant's clock at the decision; -1 = of none
    command_age_ns: int
    measured: float
    limit: float


class Command(NamedTuple):
    """Codes for the D/A, answering the sample that the frame's echo names."""

    dac_counts: LinkCounts  # 820..3276, 2048 = zero current


class ControllerState(NamedTuple):
    """The law's inputs and outputs at one sample. Force is tared and, unless the name says mean, not averaged."""

    number: int
    tick: int
    q: Links
    q_set: Links
    qd: Links
    qd_set: Links
    x_m: Links
    x_set_m: Links
    x_nominal_m: Links
    force_n: float
    force_mean_n: float
    force_set_n: float
    force_bias_n: float
    current_a: Links  # commanded to the valves, before the converter
    integral_a: Links  # integral term of each law
    boosted: LinkCounts  # 1 = integral augmented at this sample
    clamped: int  # bit mask of what the envelope clamped; 0 = nothing
    ready: int  # 1 = buffers full and the reference starts at the pose
    machine_id: int  # first 48 bits of the hash of the machine that it drives
    compute_ns: int


class Permit(NamedTuple):
    """The right to move, and the reason where there is none."""

    mode: int
    cause: int
    measured: float  # the number that tripped
    limit: float  # against this limit
    trip_number: int  # sample of the trip
    first_sample: int  # sample number at which the announced trial starts; NO_COMMAND = none
    duration_ticks: int  # of the announced trial
    tare_ticks: int
    recover_signs: LinkCounts  # signs that unload
    force_limit_n: float
    force_bias_n: float


class InboxCounts(NamedTuple):
    """Frames of one topic that a receiver accepted, missed and discarded since its start."""

    topic: str
    accepted: int
    lost: int  # numbers that were skipped
    other_run: int  # accepted, but of another run or experiment: not used
    link_faults: int  # CRC and sequence faults under the bound identity
    epoch_conflicts: int  # frames by which the bound sender has another epoch
    oversized: int  # from here on: why frames were discarded, foreign ones included
    malformed: int
    crc: int
    version: int
    schema: int
    cell: int
    sender: int
    epoch: int
    sequence: int


class LinkStats(NamedTuple):
    """Every inbox of one receiver."""

    number: int  # sample at which this was counted
    inboxes: tuple[InboxCounts, ...]


class SampleDropped(NamedTuple):
    """In lockstep: a transport fault took this sample, and it will not be answered."""

    number: int


class FaultEvent(NamedTuple):
    """A scheduled or injected fault begins or ends."""

    number: int  # first sample with it, or first without
    tick: int
    acting: int  # 1 = it begins, 0 = it has ended
    kind: str
    target: str
    value: float


class ParameterEvent(NamedTuple):
    """One parameter of the controller that has changed while a trial ran."""

    number: int  # first sample that is answered with it, or with the first of its ramp
    tick: int
    by_hand: int  # 1 = by an operator, 0 = scheduled by the experiment
    path: str  # as in the experiment
    old: str  # as TOML has it
    new: str
    ramp_samples: int  # in which it moves from old to new; 1 = at once


class Ask(NamedTuple):
    """A request to one service."""

    verb: str
    arguments: bytes  # JSON object


class Answer(NamedTuple):
    """The answer to a request; no request is confirmed by silence."""

    accepted: int
    reason: str  # why not, and what to do
    values: bytes  # JSON object
