"""Acts of operators: those that must work and those that must be refused (rows 27b, 28, 30, 33)."""

import secrets
import signal
import threading
import time
from random import Random

from hydrohil.cell import processes as cells
from hydrohil.cell.session import load, sealed
from hydrohil.faulttest.motions import PRESS, SWING, motion
from hydrohil.faulttest.observer import Observation, safe, since
from hydrohil.faulttest.processes import WATCHED_S, confirmed, judged, period_s
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.messages import NO_TRIAL, GateState, Mode
from hydrohil.shared.units import NS_PER_S

TRIP_N = 150.0  # the pressing force passes it on its way to 250 N
HELD_S = 0.8
REFUSED_S = 0.3
_RUN_BITS = 48


def hop_s(observed: Observation) -> float:
    """More than one hop of this trial: the longest way from a sample through the controller to the gate."""
    ages = [m.body.command_age_ns for m in observed.samples if m.body.tick != NO_TRIAL]
    return max(ages, default=0) / NS_PER_S


def stopped_by(rig: Rig, rng: Random, number: int, operators: int) -> Trial:
    """E-stop, pressed by one operator or by several at the same instant, at gate and supervisor."""
    experiment = motion(number)
    rig.start_moving(experiment, rng)
    revoked = int(rig.status("plant")["revoked_arming_ids"])
    rig.observer.listen()
    fault_ns = time.monotonic_ns()
    _press(rig, operators)
    observed = rig.observer.listen_for(WATCHED_S)
    return confirmed(rig, judged(observed, fault_ns, period_s(experiment) + hop_s(observed)), revoked, tripped=True)


def _press(rig: Rig, operators: int) -> None:
    """Each operator asks both, as `hydrohil estop` does."""

    def press() -> None:
        for service in ("plant", "supervisor"):
            rig.bus.ask(service, "estop", {}, 1.0)

    threads = [threading.Thread(target=press) for _ in range(operators)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def stopped_while_tripped(rig: Rig, rng: Random, number: int) -> Trial:
    """E-stop after a frozen controller has already led to a trip: it stays safe, and stays so when the controller thaws."""
    rig.start_moving(motion(number), rng)
    revoked, lease_s = int(rig.status("plant")["revoked_arming_ids"]), rig.lease_s()
    victim = rig.processes["controller"]
    fault_ns = time.monotonic_ns()
    victim.send_signal(signal.SIGSTOP)
    rig.observer.listen_for(2.0 * lease_s)
    _press(rig, 1)
    victim.send_signal(signal.SIGCONT)
    observed = rig.observer.listen_for(WATCHED_S)
    return confirmed(rig, judged(observed, fault_ns, lease_s + period_s(motion(number))), revoked, tripped=True)


def recovered(rig: Rig, rng: Random, number: int) -> Trial:
    """Over-force on the plate, RECOVER held, released, reset: only the unloading sign at low current, zero on release."""
    experiment = PRESS._replace(supervisor=PRESS.supervisor._replace(force_limit_n=TRIP_N))
    rig.start_moving(SWING, rng)  # a trial begins at its own pose, so that nothing presses on the tool any more
    rig.start_trial(experiment, rng.randrange(1 << 32))
    rig.wait_for(lambda: rig.status("supervisor").get("mode") == Mode.TRIPPED.name, "the over-force trip")
    before = rig.observer.listen().ground_truths[-1].body.contact_force_n
    hop = hop_s(rig.observer.listen())
    released_ns = rig.recover(HELD_S)
    observed = rig.observer.listen_for(REFUSED_S)
    rig.reset()
    rig.observer.listen_for(REFUSED_S)
    trial = judged(observed, released_ns, 2.0 * period_s(experiment) + hop)
    return _unloaded(trial, observed, before)


def _unloaded(trial: Trial, observed: Observation, before_n: float) -> Trial:
    moved = [m.body for m in observed.samples if m.body.gate == GateState.RECOVERING]
    wrong = sum(not all(_allowed(c, s) for c, s in zip(b.dac_counts, b.recover_signs, strict=True)) for b in moved)
    left_n = observed.ground_truths[-1].body.contact_force_n
    words = f"{trial.words}; {len(moved)} samples of RECOVER, {wrong} with another sign; from {before_n:.0f} to {left_n:.0f} N"
    return trial._replace(held=trial.held and bool(moved) and wrong == 0 and left_n < before_n, words=words)


def _allowed(code: int, sign: int) -> bool:
    """Zero, or the sign that unloads."""
    return code == ZERO_CODE or (code - ZERO_CODE) * sign > 0


def reset_refused(rig: Rig, rng: Random, number: int) -> Trial:
    """A reset while the cause stands (the plant is frozen), again and again: refused each time, and it moves nothing."""
    rig.start_moving(motion(number), rng)
    lease_s, victim = rig.lease_s(), rig.processes["plant"]
    victim.send_signal(signal.SIGSTOP)
    rig.observer.listen_for(2.0 * lease_s + REFUSED_S)
    answers = [rig.bus.ask("supervisor", "reset", {}, 2.0) for _ in range(3)]
    victim.send_signal(signal.SIGCONT)
    thawed_ns = time.monotonic_ns()
    observed = rig.observer.listen_for(WATCHED_S)
    refused = sum(answer is not None and not answer.accepted for answer in answers)
    unsafe = sum(not safe(m) for m in since(observed.samples, thawed_ns + int(0.02 * NS_PER_S)))
    return Trial(
        refused == len(answers) and unsafe == 0, f"{refused} of {len(answers)} resets refused; {unsafe} samples with current"
    )


def disagreeing(rig: Rig, rng: Random, number: int) -> Trial:
    """One service has another experiment loaded: arming is refused, and the answer names the service and the hash."""
    odd = cells.LOOP[number % len(cells.LOOP)]
    rig.reset()
    rig.observer.clear()
    run = secrets.randbits(_RUN_BITS)
    for service in cells.LOOP:
        text = sealed(motion(1 if service == odd else 0), run, 0, "real")
        digest = rig.ask(service, "load", envelope=text)["digest"]
        rig.ask(service, "commit", digest=digest)
    until, answer = time.monotonic() + REFUSED_S, None
    while time.monotonic() < until:
        answer = rig.bus.ask("supervisor", "arm", {}, 1.0)
        if answer is not None and answer.accepted:
            return Trial(False, f"armed although the {odd} has another experiment")
    load(rig.bus, motion(0), rng.randrange(1 << 32), "real", unqualified=True)
    observed = rig.observer.listen()
    named = answer is not None and "experiment" in answer.reason
    return Trial(
        named and all(safe(m) for m in observed.samples), f"the {odd} differs: {answer.reason if answer else 'no answer'}"
    )
