"""Motions that lead beyond a limit by themselves: the tool hits the stiff plate at full speed, a link passes its limit."""

from random import Random

import numpy as np

from hydrohil.experiment.criteria import SMOOTHING_S
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import ControllerConfig, Environment, GateLimits, Segment
from hydrohil.faulttest.motions import BIAS_S, SWING
from hydrohil.faulttest.observer import since, zero_at
from hydrohil.faulttest.operators import hop_s
from hydrohil.faulttest.processes import WATCHED_S, confirmed, judged, period_s
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.simulations import Bools, ended, limit_trial
from hydrohil.faulttest.trial import Trial
from hydrohil.shared.contract.messages import NO_TRIAL, Mode, TripCause
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.simulation.columns import Columns
from hydrohil.simulation.rollout import play_local
from hydrohil.thesis.chapter5 import TIP_Z_M, sampled

FORCE_N_PER_COUNT = UNIMATE.force.scale
PLATE_N_PER_M = 57.6e3  # the stiffest that the thesis measured with its gauge
BELOW_M = 0.12  # from the start to the plate: the link is at full speed when it hits
STEP_RAD = 0.35
IMPACT_S = 3.0
GATE_N = 200.0  # a gate's limit below the supervisor's, so that the gate must act first and alone
HIGH_RAD = 0.05
LEVEL_N, LEVEL_S, ENERGY_J = 100.0, 0.1, 0.5
LOW_Z_M = -0.42
IMPACT = SWING._replace(
    name="faults-impact",
    alias="faults-impact",
    title="The tool hits the stiff plate at full speed",
    duration_s=IMPACT_S,
    plant=sampled(Environment(kind="plate", stiffness_n_per_m=PLATE_N_PER_M, surface_m=TIP_Z_M - BELOW_M))._replace(
        bias_s=BIAS_S
    ),
    controller=ControllerConfig(target="joint"),
    reference=(Segment("q2", "step", 0.5, amount=STEP_RAD),),
)


PUSH = IMPACT._replace(
    name="faults-push",
    alias="faults-push",
    title="The tool is pushed into the stiff plate, slowly enough that the force itself is what passes its limit",
    duration_s=6.0,
    reference=(Segment(channel="q2", kind="ramp", start_s=0.5, duration_s=4.0, amount=0.2),),
)


def pushed_beyond_limit(seed: int) -> Trial:
    """From the first sample above the supervisor's limit of 334 N."""
    limit_n = PUSH.supervisor.force_limit_n
    return limit_trial(seed, PUSH, lambda rows: rows.force_counts * FORCE_N_PER_COUNT > limit_n + bias_n(rows), _two_periods)


def bias_n(rows: Columns) -> float:
    """Mean force while the valves are shut before the trial."""
    return float(rows.force_counts[rows.tick < 0].mean()) * FORCE_N_PER_COUNT


def cut_by_the_gate(seed: int) -> Trial:
    """From the first sample above the gate's own limit, which here lies below the supervisor's."""
    limits = GateLimits(force_limit_n=GATE_N)
    return limit_trial(seed, PUSH, lambda rows: rows.force_counts * FORCE_N_PER_COUNT > GATE_N, _one_period, limits)


def force_rate(seed: int) -> Trial:
    """The rate of the force when the plate is hit at full speed; the rule has a window of its own, so no time is bounded."""
    return _by(seed, IMPACT, TripCause.FORCE_RATE)


def long_contact(seed: int) -> Trial:
    """From the instant at which the force has stood above a tightened level for a tightened time.

    The rule judges a smoothed force, which lags a ramp by its time constant.
    """
    tight = PUSH.supervisor._replace(contact_level_n=LEVEL_N, contact_time_s=LEVEL_S)
    return limit_trial(
        seed,
        PUSH._replace(supervisor=tight),
        _to_the_end_above,
        lambda period_s: LEVEL_S + SMOOTHING_S + period_s,
    )


def _to_the_end_above(rows: Columns) -> Bools:
    """Where the force is above the level and stays there until the trial ends."""
    above = rows.force_counts * FORCE_N_PER_COUNT - bias_n(rows) > LEVEL_N
    return np.cumprod(above[::-1])[::-1].astype(np.bool_)


def contact_energy(seed: int) -> Trial:
    """The energy that goes into the plate; the supervisor judges its own estimate, so no time is bounded."""
    return _by(seed, PUSH._replace(supervisor=PUSH.supervisor._replace(contact_energy_j=ENERGY_J)), TripCause.FORCE_ENERGY)


def _by(seed: int, experiment: Experiment, cause: TripCause) -> Trial:
    """It must be ended by this rule, and by no other."""
    outcome = play_local(experiment, seed)
    return Trial(outcome.supervisor.cause == cause, ended(outcome).words)


def beyond_joint(seed: int) -> Trial:
    """The swing passes a joint limit that is tightened to lie within it."""
    high = SWING.supervisor.joint_high_q._replace(down_up=HIGH_RAD)
    experiment = SWING._replace(duration_s=IMPACT_S, supervisor=SWING.supervisor._replace(joint_high_q=high))
    return limit_trial(seed, experiment, lambda rows: rows.q[:, 1] > HIGH_RAD, _one_period)


def beyond_workspace(seed: int) -> Trial:
    """The tip leaves a workspace that is tightened to lie within its swing."""
    low = (SWING.supervisor.workspace_low_m[0], SWING.supervisor.workspace_low_m[1], LOW_Z_M)
    experiment = SWING._replace(duration_s=IMPACT_S, supervisor=SWING.supervisor._replace(workspace_low_m=low))
    return limit_trial(seed, experiment, lambda rows: rows.x_m[:, 2] < LOW_Z_M, _one_period)


def _one_period(period_s: float) -> float:
    return period_s


def _two_periods(period_s: float) -> float:
    return 2.0 * period_s


def impact_live(rig: Rig, rng: Random, number: int) -> Trial:
    """The same with real processes: from the arrival of the first sample above the limit; the overshoot in N."""
    rig.start_trial(IMPACT, rng.randrange(1 << 32))
    revoked = int(rig.status("plant")["revoked_arming_ids"])
    rig.wait_for(lambda: rig.status("supervisor").get("mode") == Mode.TRIPPED.name, "the over-force trip")
    observed = rig.observer.listen_for(WATCHED_S)
    limit_n = IMPACT.supervisor.force_limit_n
    before = [m.body.force_counts for m in observed.samples if NO_TRIAL < m.body.tick < 0]
    bias = FORCE_N_PER_COUNT * sum(before) / max(1, len(before))
    above = [m for m in observed.samples if m.body.tick >= 0 and m.body.force_counts * FORCE_N_PER_COUNT - bias > limit_n]
    began_ns = next(m.arrival_ns for m in observed.samples if m.body.tick != NO_TRIAL)  # before, the tool may still be in contact
    peak_n = max(m.body.contact_force_n for m in since(observed.ground_truths, began_ns))
    peak = f"peak {peak_n:.0f} N, overshoot {peak_n - limit_n:.0f} N"
    if not above:
        return confirmed(rig, Trial(True, f"zero current before the force limit was reached; {peak}"), revoked, tripped=True)
    trial = judged(observed, above[0].arrival_ns, 2.0 * period_s(IMPACT) + hop_s(observed))
    at_ns = zero_at(observed, above[0].arrival_ns) or above[0].arrival_ns
    samples = sum(m.arrival_ns < at_ns for m in since(observed.samples, above[0].arrival_ns)) - 1
    words = f"{trial.words}; zero {max(0, samples)} samples after the limit; {peak}"
    return confirmed(rig, trial._replace(words=words), revoked, tripped=True)
