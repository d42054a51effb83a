"""Kill or freeze one process while the valves move (rows 1, 2, 4, 5, 5b): how long until zero current, does anything resume?"""

import signal
import time
from random import Random
from typing import Any

from hydrohil.experiment.experiment import Experiment
from hydrohil.faulttest.motions import motion
from hydrohil.faulttest.observer import Observation, hops, moved, safe, since, stalled_s, unsafe_after, zero_at
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.contract.messages import GateCause, Mode
from hydrohil.shared.units import NS_PER_S, SUBSTEP_S

WATCHED_S = 1.0  # after the fault is over: nothing may resume
FROZEN_S = (0.3, 1.0)  # shorter and longer than the half second after which the transport drops a silent peer


def period_s(experiment: Experiment) -> float:
    """The sampling period T in s."""
    return experiment.plant.sample_period_substeps * SUBSTEP_S


def killed(rig: Rig, rng: Random, number: int, service: str) -> Trial:
    """SIGKILL of controller or supervisor; started again, then watched."""
    return _process_fault(rig, rng, number, service, signal.SIGKILL)


def frozen(rig: Rig, rng: Random, number: int, service: str) -> Trial:
    """SIGSTOP of controller or supervisor; thawed, then watched."""
    return _process_fault(rig, rng, number, service, signal.SIGSTOP)


def _process_fault(rig: Rig, rng: Random, number: int, service: str, how: signal.Signals) -> Trial:
    experiment = motion(number)
    rig.start_moving(experiment, rng)
    revoked, lease_s = int(rig.status("plant")["revoked_arming_ids"]), rig.lease_s()
    bound_s = lease_s + period_s(experiment)
    victim = rig.processes[service]
    rig.observer.listen()
    fault_ns = time.monotonic_ns()
    victim.send_signal(how)
    rig.observer.listen_for(bound_s + rng.uniform(*FROZEN_S))
    if how == signal.SIGSTOP:
        victim.send_signal(signal.SIGCONT)
    else:
        victim.wait()
        rig.restart_ended()
    observed = rig.observer.listen_for(WATCHED_S)
    trial = judged(observed, fault_ns, bound_s)
    return confirmed(rig, trial, revoked, tripped=not (service == "supervisor" and how == signal.SIGKILL))


def judged(observed: Observation, fault_ns: int, bound_s: float) -> Trial:
    """The reaction to a fault, what moved, and whether anything resumed in the messages since."""
    at_ns = zero_at(observed, fault_ns)
    moved_mm, force_n = moved(observed, fault_ns)
    if at_ns is None:
        return Trial(False, "the current never went to zero", bound_s=bound_s, moved_mm=moved_mm, force_n=force_n)
    resumed = unsafe_after(observed, at_ns)
    trial = Trial(
        held=resumed == 0,
        words=f"{resumed} samples with current after zero" if resumed else "zero current, and nothing resumed",
        reaction_s=(at_ns - fault_ns) / NS_PER_S,
        bound_s=bound_s,
        stalled_s=stalled_s(observed, fault_ns),
        moved_mm=moved_mm,
        force_n=force_n,
        hops=hops(observed, at_ns),
    )
    return trial if trial.in_time else trial._replace(held=False, words=f"zero current too late; {trial.words}")


def confirmed(rig: Rig, trial: Trial, revoked: int, *, tripped: bool) -> Trial:
    """`trial`, if the arming is revoked and, where it is still the same process, the supervisor has latched a trip."""
    plant, supervisor = rig.status("plant"), rig.status("supervisor")
    if not plant or int(plant["revoked_arming_ids"]) <= revoked:
        return trial._replace(held=False, words=f"{trial.words}; the arming is not revoked")
    if tripped and supervisor.get("mode") != Mode.TRIPPED.name:
        return trial._replace(held=False, words=f"{trial.words}; the supervisor is {supervisor.get('mode')}, not TRIPPED")
    return trial._replace(words=f"{trial.words}; {supervisor.get('words') or 'the gate: ' + str(plant['last_cut'])}")


def plant_killed(rig: Rig, rng: Random, number: int) -> Trial:
    """SIGKILL of the plant: the supervisor must trip; the plant that returns must stay at zero."""
    experiment = motion(number)
    rig.start_moving(experiment, rng)
    bound_s = rig.lease_s() + period_s(experiment)
    victim = rig.processes["plant"]
    rig.observer.listen()
    fault_ns = time.monotonic_ns()
    victim.kill()
    victim.wait()
    rig.observer.listen_for(bound_s + rng.uniform(*FROZEN_S))
    rig.restart_ended()
    observed = rig.observer.listen_for(WATCHED_S)
    trip_ns = next((m.arrival_ns for m in since(observed.permits, fault_ns) if m.body.mode == Mode.TRIPPED), None)
    returned = [sample for sample in since(observed.samples, fault_ns) if sample.header.epoch != observed.samples[0].header.epoch]
    unsafe = sum(not safe(sample) for sample in returned)
    mode = rig.status("supervisor").get("mode")
    held = trip_ns is not None and bool(returned) and unsafe == 0 and mode == Mode.TRIPPED.name
    words = f"supervisor {mode}; {len(returned)} samples after its return, {unsafe} of them with current"
    reaction_s = (trip_ns - fault_ns) / NS_PER_S if trip_ns else float("nan")
    trial = Trial(held, words, reaction_s, bound_s, hops=hops(observed, trip_ns or fault_ns))
    return trial if trial.in_time else trial._replace(held=False, words=f"the supervisor trips too late; {words}")


def plant_frozen(rig: Rig, rng: Random, number: int) -> Trial:
    """SIGSTOP of the plant. Its emulated D/A falls to zero after one lease of simulated time, which stands still meanwhile.

    So the thaw is judged: the first sample after it has zero current, the arming is revoked, and simulated time went on by no
    more than the samples between. A sample that was under way when the plant froze is not counted.
    """
    experiment = motion(number)
    rig.start_moving(experiment, rng)
    revoked, lease_s = int(rig.status("plant")["revoked_arming_ids"]), rig.lease_s()
    victim = rig.processes["plant"]
    victim.send_signal(signal.SIGSTOP)
    rig.observer.listen_for(lease_s + rng.uniform(*FROZEN_S))
    before = rig.observer.observed.samples[-1]
    thawed_ns = time.monotonic_ns()
    victim.send_signal(signal.SIGCONT)
    observed = rig.observer.listen_for(WATCHED_S)
    trial = judged(observed, thawed_ns, float("nan"))
    after = [sample for sample in since(observed.samples, thawed_ns) if sample.body.number > before.body.number]
    trial = confirmed(rig, trial, revoked, tripped=True)
    return _thawed(trial, before, after, longest_s(experiment), rig.status("plant"))


def longest_s(experiment: Experiment) -> float:
    """The longest interval between two samples, with its jitter."""
    return (experiment.plant.sample_period_substeps + experiment.plant.jitter_substeps) * SUBSTEP_S


def _thawed(trial: Trial, before: Any, after: list[Any], longest: float, plant: dict[str, Any]) -> Trial:
    """The plant's first messages after the thaw: safe, by its own cause, and no simulated time lost or gained."""
    if not after:
        return trial._replace(held=False, words="the plant sent nothing after thawing")
    unsafe = sum(not safe(sample) for sample in after)
    samples = after[0].body.number - before.body.number
    simulated_s = (after[0].body.time_ns - before.body.time_ns) / NS_PER_S
    overrun = plant.get("last_cut") == GateCause.OVERRUN.name
    zero_and_in_step = unsafe == 0 and overrun and simulated_s <= samples * longest
    words = (
        f"{trial.words}; after thawing {unsafe} samples with current, cut {plant.get('last_cut')}, simulated time went on by "
        f"{1000.0 * simulated_s:.1f} ms in {samples} samples"
    )
    return trial._replace(held=trial.held and zero_and_in_step, words=words)
