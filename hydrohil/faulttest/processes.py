"""Kill or freeze one process while the valves move (rows 1, 2, 4, 5, 5b): how long until zero current, does anything resume?"""

import signal
import time
from random import Random
from typing import Any

from hydrohil.experiment.experiment import Experiment
from hydrohil.faulttest.motions import motion
from hydrohil.faulttest.observer import Heard, hops, moved, safe, since, stalled_s, unsafe_after, zero_at
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.contract.messages import GateCause, Mode
from hydrohil.shared.units import NS_PER_S, SUBSTEP_S

WATCHED_S = 1.0  # after healing: nothing may resume
FROZEN_S = (0.3, 1.0)  # shorter and longer than the transport's own patience of half a second


def period_s(experiment: Experiment) -> float:
    """T."""
    return experiment.plant.sample_period_substeps * SUBSTEP_S


def killed(rig: Rig, dice: Random, number: int, service: str) -> Trial:
    """SIGKILL of controller or supervisor; started again, then watched."""
    return _struck(rig, dice, number, service, signal.SIGKILL)


def frozen(rig: Rig, dice: Random, number: int, service: str) -> Trial:
    """SIGSTOP of controller or supervisor; thawed, then watched."""
    return _struck(rig, dice, number, service, signal.SIGSTOP)


def _struck(rig: Rig, dice: Random, number: int, service: str, how: signal.Signals) -> Trial:
    experiment = motion(number)
    rig.moving(experiment, dice)
    revoked, lease_s = int(rig.status("plant")["revoked_arming_ids"]), rig.lease_s()
    bound_s = lease_s + period_s(experiment)
    victim = rig.processes[service]
    rig.observer.listen()
    blow_ns = time.monotonic_ns()
    victim.send_signal(how)
    rig.observer.listen_for(bound_s + dice.uniform(*FROZEN_S))
    if how == signal.SIGSTOP:
        victim.send_signal(signal.SIGCONT)
    else:
        victim.wait()
        rig.revive()
    heard = rig.observer.listen_for(WATCHED_S)
    trial = judged(heard, blow_ns, bound_s)
    return confirmed(rig, trial, revoked, tripped=not (service == "supervisor" and how == signal.SIGKILL))


def judged(heard: Heard, blow_ns: int, bound_s: float) -> Trial:
    """The reaction to a blow, what moved, and whether anything resumed in what was heard since."""
    at_ns = zero_at(heard, blow_ns)
    way_mm, force_n = moved(heard, blow_ns)
    if at_ns is None:
        return Trial(False, "the current never went to zero", bound_s=bound_s, moved_mm=way_mm, force_n=force_n)
    resumed = unsafe_after(heard, at_ns)
    trial = Trial(
        resumed == 0,
        f"{resumed} samples with current after zero" if resumed else "zero current, and nothing resumed",
        (at_ns - blow_ns) / NS_PER_S,
        bound_s,
        stalled_s(heard, blow_ns),
        way_mm,
        force_n,
        hops(heard, at_ns),
    )
    return trial if trial.in_time else trial._replace(held=False, words=f"zero current too late; {trial.words}")


def confirmed(rig: Rig, trial: Trial, revoked: int, *, tripped: bool) -> Trial:
    """`trial`, if the arming is revoked and the supervisor has latched a trip where it lived through."""
    plant, supervisor = rig.status("plant"), rig.status("supervisor")
    if not plant or int(plant["revoked_arming_ids"]) <= revoked:
        return trial._replace(held=False, words=f"{trial.words}; the arming is not revoked")
    if tripped and supervisor.get("mode") != Mode.TRIPPED.name:
        return trial._replace(held=False, words=f"{trial.words}; the supervisor is {supervisor.get('mode')}, not TRIPPED")
    return trial._replace(words=f"{trial.words}; {supervisor.get('words') or 'the gate: ' + str(plant['last_cut'])}")


def plant_killed(rig: Rig, dice: Random, number: int) -> Trial:
    """SIGKILL of the plant: the supervisor must trip; the plant that returns must stay at zero."""
    experiment = motion(number)
    rig.moving(experiment, dice)
    bound_s = rig.lease_s() + period_s(experiment)
    victim = rig.processes["plant"]
    rig.observer.listen()
    blow_ns = time.monotonic_ns()
    victim.kill()
    victim.wait()
    rig.observer.listen_for(bound_s + dice.uniform(*FROZEN_S))
    rig.revive()
    heard = rig.observer.listen_for(WATCHED_S)
    told = next((m.arrival_ns for m in since(heard.permits, blow_ns) if m.body.mode == Mode.TRIPPED), None)
    returned = [sample for sample in since(heard.samples, blow_ns) if sample.header.epoch != heard.samples[0].header.epoch]
    unsafe = sum(not safe(sample) for sample in returned)
    mode = rig.status("supervisor").get("mode")
    held = told is not None and bool(returned) and unsafe == 0 and mode == Mode.TRIPPED.name
    words = f"supervisor {mode}; {len(returned)} samples after its return, {unsafe} of them with current"
    reaction_s = (told - blow_ns) / NS_PER_S if told else float("nan")
    trial = Trial(held, words, reaction_s, bound_s, hops=hops(heard, told or blow_ns))
    return trial if trial.in_time else trial._replace(held=False, words=f"the supervisor trips too late; {words}")


def plant_frozen(rig: Rig, dice: Random, number: int) -> Trial:
    """SIGSTOP of the plant. Its emulated D/A falls to zero after one lease of simulated time, which stands still meanwhile.

    So what is judged is the waking: the first word is zero current, the arming is revoked, and simulated time went on by no
    more than the samples between. A sample that was under way when the plant froze is no waking.
    """
    experiment = motion(number)
    rig.moving(experiment, dice)
    revoked, lease_s = int(rig.status("plant")["revoked_arming_ids"]), rig.lease_s()
    victim = rig.processes["plant"]
    victim.send_signal(signal.SIGSTOP)
    rig.observer.listen_for(lease_s + dice.uniform(*FROZEN_S))
    before = rig.observer.heard.samples[-1]
    thawed_ns = time.monotonic_ns()
    victim.send_signal(signal.SIGCONT)
    heard = rig.observer.listen_for(WATCHED_S)
    trial = judged(heard, thawed_ns, float("nan"))
    after = [sample for sample in since(heard.samples, thawed_ns) if sample.body.number > before.body.number]
    trial = confirmed(rig, trial, revoked, tripped=True)
    return _woken(trial, before, after, longest_s(experiment), rig.status("plant"))


def longest_s(experiment: Experiment) -> float:
    """The longest interval between two samples, with its jitter."""
    return (experiment.plant.sample_period_substeps + experiment.plant.jitter_substeps) * SUBSTEP_S


def _woken(trial: Trial, before: Any, after: list[Any], longest: float, plant: dict[str, Any]) -> Trial:
    """The plant's first words: safe, by its own cause, and no simulated time lost or gained."""
    if not after:
        return trial._replace(held=False, words="the plant said nothing after thawing")
    unsafe = sum(not safe(sample) for sample in after)
    samples = after[0].body.number - before.body.number
    simulated_s = (after[0].body.time_ns - before.body.time_ns) / NS_PER_S
    overrun = plant.get("last_cut") == GateCause.OVERRUN.name
    whole = unsafe == 0 and overrun and simulated_s <= samples * longest
    words = (
        f"{trial.words}; after thawing {unsafe} samples with current, cut {plant.get('last_cut')}, simulated time went on by "
        f"{1000.0 * simulated_s:.1f} ms in {samples} samples"
    )
    return trial._replace(held=trial.held and whole, words=words)
