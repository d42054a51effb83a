"""What a rule is: what it judges, and against what. The rows stand in the files of their subjects.

What is said of a broken rule stands in shared/trips/causes.py.
"""

from collections.abc import Callable
from typing import NamedTuple

from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.shared.contract.messages import TripCause
from hydrohil.shared.machine.description import Gauge, MotionBounds, Triple


class GaugeObservation(NamedTuple):
    """The force gauge."""

    force_counts: int
    raw_n: float
    tared_n: float
    bias_n: float
    bias_spread_n: float
    smooth_n: float  # tared
    rate_n_per_s: float  # of the smooth force
    jump_n: float  # since the sample before
    jump_limit_n: float  # what noise and motion explain of it
    unexplained_n: float  # above what earlier readings and the way into the environment explain
    unexplained_limit_n: float
    quiet_samples: int  # in a row whose reading did not change by more than the quietest gauge's
    held_ns: int  # above the contact level
    energy_j: float  # put into the environment by this contact


class MotionObservation(NamedTuple):
    """Joints and tip; link 3 in m."""

    q: Triple
    tip_m: Triple
    counts: tuple[int, int, int]
    moved_q: tuple[float, float, float, float]  # since the sample before; the fourth is the hand's pitch
    dt_s: float
    speed: Triple  # smooth
    tip_speed_m_per_s: float  # smooth
    idle_ns: tuple[int, int, int]  # without getting further under a current that must move the link
    against: Triple  # way against such a current


class TransportObservation(NamedTuple):
    """Messages and the services that send them."""

    lost_samples: int  # between this sample and the one before
    stale_ns: int  # wall time without a sample, 0 when one came
    command_lag: int  # samples since the one that the newest command answers
    gate: int
    ready: bool  # the controller reports that it is
    link_faults: int  # CRC and sequence faults of the last second under a bound identity, of the worst link
    epoch_conflicts: int  # frames of the last second by which a bound sender has another epoch, of the worst link
    other_run: int  # frames since the last verdict that belong to another run or experiment than a running permit
    state_lag: int  # samples since the one that the controller's newest state answers
    missed: int  # of the last 100 samples, those that were not answered in time


class Observed(NamedTuple):
    """What the rules judge, computed from one sample and what came before it."""

    moving: bool  # a trial runs and its tick is 0 or later, or its samples went back
    starting: bool  # a trial runs and its tick is -1 or later: what must hold before motion starts
    tick: int
    gauge: GaugeObservation
    motion: MotionObservation
    transport: TransportObservation


class Limits(NamedTuple):
    """The experiment's limits, the machine's and those of the transport."""

    config: SupervisorConfig
    gauge: Gauge
    motion: MotionBounds
    min_force_counts: int
    max_force_counts: int
    quiet_samples: int
    low_counts: tuple[int, int, int]  # ends of the counters: an encoder without its cable stands there
    high_counts: tuple[int, int, int]
    count_q: tuple[float, float, float, float]  # of each encoder; the fourth is the hand's pitch
    lease_samples: int
    lease_ns: int
    faults_per_s: int
    missed_samples: int


Verdict = Callable[[Observed, Limits], bool]
Number = Callable[[Observed, Limits], float]


class Rule(NamedTuple):
    """One row: what must hold, the cause if it does not, the number, and its limit."""

    holds: Verdict
    cause: TripCause
    measured: Number
    limit: Number
