"""Transport faults in lockstep: real processes, simulated time, counted in samples and exact to the latch."""

from collections.abc import Callable, Sequence
from random import Random

from hydrohil.cell.processes import CellError
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import latch_substeps
from hydrohil.faulttest.motions import SWING, motion
from hydrohil.faulttest.observer import Observation, safe
from hydrohil.faulttest.processes import WATCHED_S, confirmed, judged
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.faults import Fault, ticks_of
from hydrohil.shared.contract.messages import GateCause, Mode, TripCause
from hydrohil.shared.units import NS_PER_S, SUBSTEP_NS, SUBSTEP_S

AT_S = (0.4, 0.8)  # the fault begins between these times of the trial
AFTER_S = 1.2  # of the trial, after the fault has begun
LOSSY_S = 6.0  # of the trial, so that it holds a long run of losses
QUIET_S = 0.1  # of wall time, after the trial has ended
PATIENCE_S = 30.0
T_S, T_NS = SWING.plant.sample_period_substeps * SUBSTEP_S, SWING.plant.sample_period_substeps * SUBSTEP_NS
LATCH_S = latch_substeps(SWING.plant._replace(jitter_substeps=0)) * SUBSTEP_S
Faults = Callable[[float, float], tuple[Fault, ...]]  # of the instant at which they begin and the lease, in s


def survivable(lease_s: float) -> int:
    """Number of commands in a row that may be lost:  m T + latch <= lease."""
    return int((lease_s - LATCH_S) / T_S + 1e-9)


def trial_of(faults: tuple[Fault, ...], duration_s: float) -> Experiment:
    """The swing on an even grid, so that a lease is a whole number of samples."""
    return SWING._replace(plant=SWING.plant._replace(jitter_substeps=0), duration_s=duration_s, faults=faults)


def played(rig: Rig, rng: Random, faults: Faults, after_s: float = AFTER_S) -> tuple[Observation, int]:
    """The messages of a trial, and the index of its first sample that has the fault."""
    rig.reset()
    at_s, lease_s = rng.uniform(*AT_S), rig.lease_s()
    injected = faults(at_s, lease_s)
    rig.start_trial(trial_of(injected, at_s + after_s), rng.randrange(1 << 32), "lockstep")
    rig.wait_for(lambda: _over(rig), "the trial's end", PATIENCE_S)
    observed = rig.observer.listen_for(QUIET_S)
    first = next((i for i, m in enumerate(observed.samples) if _has(m, injected[0])), None)
    if first is None:
        causes = ", ".join(GateCause(m.body.cause).name for m in observed.gates)
        raise CellError(f"the trial ended before its fault: {rig.state()}; the gate's decisions: {causes}")
    return observed, first


def _over(rig: Rig) -> bool:
    """Whether the supervisor has ended or tripped a trial that ran."""
    modes = [m.body.mode for m in rig.observer.listen().permits]
    return Mode.RUNNING in modes and modes[-1] in (Mode.TRIPPED, Mode.DISARMED)


def stopped(rig: Rig, rng: Random, _: int, faults: Faults, bound: Callable[[float], float]) -> Trial:
    """The fault must lead to zero current within `bound` of the lease, in simulated time."""
    observed, first = played(rig, rng, faults)
    lease_s = rig.lease_s()
    return _timed(rig, observed.samples, first, bound(lease_s))


def _timed(rig: Rig, samples: Sequence[Received], first: int, bound_s: float) -> Trial:
    zero = next((i for i in range(first + 1, len(samples)) if safe(samples[i])), None)
    if zero is None:
        return Trial(False, f"the current never went to zero: {rig.state()}", bound_s=bound_s)
    cut_ns = samples[zero - 1].body.time_ns + round(LATCH_S * NS_PER_S)  # a sample shows what was decided at the latch before it
    reaction_s = (cut_ns - samples[first].body.time_ns) / NS_PER_S
    resumed = sum(not safe(m) for m in samples[zero:])
    mode = rig.status("supervisor").get("mode")
    held = reaction_s <= bound_s + SUBSTEP_NS / NS_PER_S / 2 and resumed == 0 and mode == Mode.TRIPPED.name
    words = f"{zero - 1 - first} samples after the first that has it; {resumed} with current afterwards; {rig.state()}"
    return Trial(held, words, reaction_s, bound_s)


def tolerated(rig: Rig, rng: Random, _: int, faults: Faults) -> Trial:
    """The fault must not end the trial."""
    observed, first = played(rig, rng, faults)
    tripped = rig.status("supervisor").get("mode") == Mode.TRIPPED.name
    return Trial(not tripped, f"{len(observed.samples) - first} samples since the fault; {rig.state()}")


def lossy(rig: Rig, rng: Random, _: int, share: float) -> Trial:
    """Commands are lost at random: the current ends with the first run of losses that is longer than the lease, and not before.

    It may also end because too few of the last 100 samples were answered in time.
    """
    observed, first = played(rig, rng, on("loss", "controller>plant", share), LOSSY_S)
    allowed = survivable(rig.lease_s())
    run, longest, lost, zero = 0, 0, 0, None
    for i in range(first + 1, len(observed.samples)):
        body = observed.samples[i].body
        if safe(observed.samples[i]):
            zero = i
            break
        run = run + 1 if body.command_number < body.number - 1 else 0
        lost, longest = lost + (run > 0), max(longest, run)
    count = (zero or len(observed.samples)) - first - 1
    supervisor = rig.status("supervisor")
    cut = supervisor.get("mode") == Mode.TRIPPED.name and supervisor.get("cause") != TripCause.QUALITY.name
    survived = (1.0 - share ** (allowed + 1)) ** count
    words = (
        f"{lost} of {count} commands lost, {longest} in a row before the end; the lease allows {allowed}, so that many samples "
        f"pass with probability {survived:.2g}; {rig.state()}"
    )
    return Trial(longest <= allowed and (run == allowed or not cut), words)


def on(kind: str, target: str, value: float = 0.0, lasts_s: float = 0.0) -> Faults:
    """One fault, from its instant on."""
    return lambda at_s, _lease_s: (Fault(kind=kind, target=target, at_s=at_s, lasts_s=lasts_s, value=value),)


def burst(beyond: int) -> Faults:
    """As many commands in a row are lost as the lease allows, and `beyond` more."""
    return lambda at_s, lease_s: (
        Fault(kind="burst", target="controller>plant", at_s=at_s, lasts_s=0.0, value=float(survivable(lease_s) + beyond)),
    )


def delayed(share: float) -> Faults:
    """Every command is delayed by this share of the lease."""
    return lambda at_s, lease_s: (
        Fault(kind="delay", target="controller>plant", at_s=at_s, lasts_s=0.0, value=1000.0 * share * lease_s),
    )


def live(rig: Rig, rng: Random, number: int, target: str) -> Trial:
    """A partition with the wall clock: from the arrival of the first sample that has it."""
    at_s = rng.uniform(*AT_S)
    fault = Fault("partition", target, at_s)
    experiment = motion(number)._replace(faults=(fault,))
    rig.start_trial(experiment, rng.randrange(1 << 32))
    revoked = int(rig.status("plant")["revoked_arming_ids"])
    lease_s = rig.lease_s()
    rig.wait_for(lambda: any(_has(m, fault) for m in rig.observer.listen().samples[-20:]), "the partition")
    observed = rig.observer.listen_for(lease_s + WATCHED_S)
    fault_ns = next(m.arrival_ns for m in observed.samples if _has(m, fault))
    return confirmed(rig, judged(observed, fault_ns, lease_and_period(lease_s)), revoked, tripped=True)


def _has(sample: Received, fault: Fault) -> bool:
    """Whether the sample has the fault; by its tick, since with jitter the time of a trial drifts from the nominal one."""
    return bool(sample.body.tick >= ticks_of(fault, T_NS)[0])


def lease_and_period(lease_s: float) -> float:
    """Lease + T."""
    return lease_s + T_S


def without_the_controller(lease_s: float) -> float:
    """Lease + 3 T: the supervisor judges sample n by the controller's message on n - 1, and in whole samples."""
    return lease_s + 3.0 * T_S
