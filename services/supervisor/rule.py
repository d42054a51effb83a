"""What a rule is: what it judges, against what, and what it says. The rows stand in the files of their subjects."""

from collections.abc import Callable
from typing import NamedTuple

from services.supervisor.config import SupervisorConfig
from shared.messages import TripCause
from shared.pose import Triple


class GaugeSeen(NamedTuple):
    """The force gauge."""

    counts: int
    raw_n: float
    tared_n: float
    bias_n: float
    bias_spread_n: float


class MotionSeen(NamedTuple):
    """Joints and tip."""

    q_rad: Triple
    tip_m: Triple


class TransportSeen(NamedTuple):
    """Messages and those who send them."""

    lost_samples: int  # between this sample and the one before
    stale_ns: int  # wall time without a sample, 0 when one came
    command_lag: int  # samples since the one that the newest command answers
    gate: int
    ready: bool  # the controller says so
    link_faults: int  # CRC and sequence faults of the last second under a bound identity, of the worst link
    rivals: int  # frames of the last second by which a bound sender has another epoch, of the worst link
    other_run: int  # frames since the last verdict that belong to another run or experiment than a running permit
    missed: int  # of the last 100 samples, those that were not answered in time


class Observed(NamedTuple):
    """What the rules judge, computed from one sample and what came before it."""

    moving: bool  # a trial runs and its tick is 0 or later, or its samples went back
    starting: bool  # a trial runs and its tick is -1 or later: what must hold before motion starts
    tick: int
    gauge: GaugeSeen
    motion: MotionSeen
    transport: TransportSeen


class Limits(NamedTuple):
    """The experiment's limits, the gauge's and those of the transport."""

    config: SupervisorConfig
    min_force_counts: int
    max_force_counts: int
    lease_samples: int
    lease_ns: int
    faults_per_s: int
    missed_samples: int


Verdict = Callable[[Observed, Limits], bool]
Number = Callable[[Observed, Limits], float]


class Rule(NamedTuple):
    """One row: what must hold, the cause if it does not, the number, its limit, and the words."""

    holds: Verdict
    cause: TripCause
    measured: Number
    limit: Number
    words: str
