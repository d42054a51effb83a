"""Transport faults in lockstep: real processes, simulated time, counted in samples and exact to the latch."""

from collections.abc import Callable, Sequence
from random import Random

from battery.observer import Heard, safe
from battery.rig import Rig
from battery.swings import SWING
from battery.trial import Trial
from experiments.experiment import Experiment
from services.plant.config import latch_substeps
from shared.codec import Received
from shared.faults import Fault
from shared.messages import Mode
from shared.units import NS_PER_S, SUBSTEP_NS, SUBSTEP_S

AT_S = (0.4, 0.8)  # the fault begins somewhere between
AFTER_S = 1.2  # of the trial, after the fault has begun
QUIET_S = 0.1  # of wall time, after the trial has ended
PATIENCE_S = 30.0
T_S = SWING.plant.sample_period_substeps * SUBSTEP_S
LATCH_S = latch_substeps(SWING.plant._replace(jitter_substeps=0)) * SUBSTEP_S
Faults = Callable[[float, float], tuple[Fault, ...]]  # of the instant at which they begin and the lease, in s


def survivable(lease_s: float) -> int:
    """So many commands in a row may be lost:  m T + latch <= lease."""
    return int((lease_s - LATCH_S) / T_S + 1e-9)


def trial_of(faults: tuple[Fault, ...], duration_s: float) -> Experiment:
    """The swing on an even grid, so that a lease is a whole number of samples."""
    return SWING._replace(plant=SWING.plant._replace(jitter_substeps=0), duration_s=duration_s, faults=faults)


def played(rig: Rig, dice: Random, faults: Faults) -> tuple[Heard, int]:
    """What was heard of a trial, and where in its samples the first one is that has the fault."""
    rig.calm()
    at_s, lease_s = dice.uniform(*AT_S), rig.lease_s()
    rig.started(trial_of(faults(at_s, lease_s), at_s + AFTER_S), dice.randrange(1 << 32), "lockstep")
    rig.await_(lambda: _over(rig), "the trial's end", PATIENCE_S)
    heard = rig.observer.listen_for(QUIET_S)
    first = next(i for i, m in enumerate(heard.samples) if m.body.tick >= 0 and m.body.trial_time_ns >= at_s * NS_PER_S)
    return heard, first


def _over(rig: Rig) -> bool:
    """Whether the supervisor has ended or tripped a trial that ran."""
    modes = [m.body.mode for m in rig.observer.listen().permits]
    return Mode.RUNNING in modes and modes[-1] in (Mode.TRIPPED, Mode.DISARMED)


def stopped(rig: Rig, dice: Random, _: int, faults: Faults, bound: Callable[[float], float]) -> Trial:
    """The fault must lead to zero current within `bound` of the lease, in simulated time."""
    heard, first = played(rig, dice, faults)
    lease_s = rig.lease_s()
    return _timed(rig, heard.samples, first, bound(lease_s))


def _timed(rig: Rig, samples: Sequence[Received], first: int, bound_s: float) -> Trial:
    zero = next((i for i in range(first + 1, len(samples)) if safe(samples[i])), None)
    if zero is None:
        return Trial(False, f"the current never went to zero: {rig.words()}", bound_s=bound_s)
    cut_ns = samples[zero - 1].body.time_ns + round(LATCH_S * NS_PER_S)  # a sample tells what the latch before it decided
    reaction_s = (cut_ns - samples[first].body.time_ns) / NS_PER_S
    resumed = sum(not safe(m) for m in samples[zero:])
    mode = rig.status("supervisor").get("mode")
    held = reaction_s <= bound_s + SUBSTEP_NS / NS_PER_S / 2 and resumed == 0 and mode == Mode.TRIPPED.name
    words = f"{zero - 1 - first} samples after the first that has it; {resumed} with current afterwards; {rig.words()}"
    return Trial(held, words, reaction_s, bound_s)


def borne(rig: Rig, dice: Random, _: int, faults: Faults) -> Trial:
    """The fault must not end the trial."""
    heard, first = played(rig, dice, faults)
    tripped = rig.status("supervisor").get("mode") == Mode.TRIPPED.name
    return Trial(not tripped, f"{len(heard.samples) - first} samples since the fault; {rig.words()}")


def on(kind: str, target: str, value: float = 0.0, lasts_s: float = 0.0) -> Faults:
    """One fault from its instant on."""
    return lambda at_s, _lease_s: (Fault(kind, target, at_s, lasts_s, value),)


def burst(beyond: int) -> Faults:
    """So many commands in a row are lost as the lease bears, and `beyond` more."""
    return lambda at_s, lease_s: (Fault("burst", "controller>plant", at_s, 0.0, float(survivable(lease_s) + beyond)),)


def delayed(share: float) -> Faults:
    """Every command later by this share of the lease."""
    return lambda at_s, lease_s: (Fault("delay", "controller>plant", at_s, 0.0, 1000.0 * share * lease_s),)


def lease_and_period(lease_s: float) -> float:
    """Lease + T."""
    return lease_s + T_S
