"""The controller: one sample in, three D/A codes out (thesis 5.1.3 around chapter 4; `joystick_manipulate` of Appendix F).

While the gate is shut the controller tracks: set-point = measured, integrals 0, target model at rest, codes zero.
The law runs at tick 0, whose sample cannot yet report the gate that this very answer opens, and while the gate is open.
"""

import math
from typing import NamedTuple

from hydrohil.services.controller.explicit import FILTERS_AT_REST, ExplicitState
from hydrohil.services.controller.filtering import Filtered, filter_step
from hydrohil.services.controller.impedance import ImpedanceState, mean_of_three, rest
from hydrohil.services.controller.kinematics import joint_loads
from hydrohil.services.controller.laws import AT_REST, LinkLawState, law_step, load_feedforward, take_over
from hydrohil.services.controller.params import ControllerParams, LinkGains
from hydrohil.services.controller.reference import Table, reference_deltas
from hydrohil.services.controller.regression import Window, filled_window, push, velocities
from hydrohil.services.controller.setpoint import Seen, Setpoints, judge_ready, nominal_joints, setpoints
from hydrohil.services.controller.setpoint_scaling import Offset
from hydrohil.services.controller.trial import Trial, advance, follows, runs
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.converters import code_to_current, current_to_code
from hydrohil.shared.contract.messages import NO_TRIAL, ControllerState, GateState, Sample
from hydrohil.shared.contract.pose import forward, joint_positions
from hydrohil.shared.machine.description import Drive, Triple
from hydrohil.shared.units import NS_PER_S

GATE_RECOVERING = int(GateState.RECOVERING)
BEFORE_START_S = -1.0  # reference time outside a trial: no segment has begun

Codes = tuple[int, int, int]
Laws = tuple[LinkLawState, LinkLawState, LinkLawState]
LAWS_AT_REST = (AT_REST, AT_REST, AT_REST)


class Handover(NamedTuple):
    """What a change of parameters leaves to the samples that follow it."""

    links: int = 0  # bit mask of those whose law or gains are others from the next sample on
    tight_until: int = 0  # number of the first sample at which its tight slew limit holds no more


NOTHING_CHANGED = Handover()


class ControlMemory(NamedTuple):
    """What the controller carries from sample to sample."""

    trial: Trial
    window: Window
    force_counts: tuple[int, int]  # last, before last
    filtered: Filtered  # the gauge before its bias is taken off
    force_set_n: tuple[float, float]
    impedance: ImpedanceState
    explicit: ExplicitState
    offset: Offset
    qd: Triple  # at the last sample
    laws: Laws
    ready: int  # judged while tracking, kept while the law runs
    handover: Handover


class Force(NamedTuple):
    """The gauge at one sample, in N."""

    tared_n: float
    mean_n: float  # tared, over three samples or low-passed: what the target model feels
    bias_n: float


class Actuation(NamedTuple):
    """What the laws make of one sample."""

    laws: Laws
    current_a: Triple
    boosted: tuple[int, int, int]
    codes: Codes


def control_start(params: ControllerParams) -> ControlMemory:
    """Memory of a controller that has seen nothing; the first sample fills it."""
    origin = (0.0, 0.0, 0.0)
    trial = Trial(-1, NO_TRIAL, 0, False, False, 0, origin, origin, 0, 0)
    window = filled_window(0, origin, params.sample_period_ns)
    start, still, nothing = rest(origin, origin), Filtered(0.0, 0.0), Offset(0.0, origin)
    return ControlMemory(
        trial, window, (0, 0), still, (0.0, 0.0), start, FILTERS_AT_REST, nothing, origin, LAWS_AT_REST, 0, NOTHING_CHANGED
    )


@kernel
def begin(memory: ControlMemory, params: ControllerParams, sample: Sample, q: Triple, x: Triple) -> ControlMemory:
    """Memory before this sample: everything starts anew at a trial's first tick and wherever the samples do not follow."""
    first = sample.tick == params.first_tick and sample.tick < 0
    if not first and follows(memory.trial, sample):
        return memory
    trial = Trial(sample.number, sample.tick, sample.time_ns, first, first, 0, q, x, 0, 0)
    window = filled_window(sample.time_ns - params.sample_period_ns, q, params.sample_period_ns)
    counts = (sample.force_counts, sample.force_counts)
    filtered, still = Filtered(params.calibration.force_n_per_count * sample.force_counts, 0.0), (0.0, 0.0, 0.0)
    start, nothing = rest(x, x), Offset(0.0, x)
    return ControlMemory(
        trial, window, counts, filtered, (0.0, 0.0), start, FILTERS_AT_REST, nothing, still, LAWS_AT_REST, 0, NOTHING_CHANGED
    )


@kernel
def tare(params: ControllerParams, counts: int, before: tuple[int, int], filtered: Filtered, trial: Trial) -> Force:
    """The gauge in N without the bias that the trial's negative ticks have averaged so far."""
    newton_per_count, bias_n = params.calibration.force_n_per_count, 0.0
    if trial.bias_samples > 0:
        bias_n = newton_per_count * (trial.bias_sum_counts / trial.bias_samples)
    raw_n = newton_per_count * counts
    mean_n = mean_of_three(raw_n, newton_per_count * before[0], newton_per_count * before[1])
    if params.force_cutoff_rad_per_s > 0.0:
        mean_n = filtered.force_n
    return Force(raw_n - bias_n, mean_n - bias_n, bias_n)


@kernel
def slewed_code(drive: Drive, current_a: float, accepted: int, limit: int) -> int:
    """Code for `current_a`, at most `limit` from the code that the gate last accepted; at once zero if it is not finite."""
    if not abs(current_a) < math.inf:
        return drive.zero_code
    code = current_to_code(drive, current_a)
    if code > accepted + limit:
        return accepted + limit
    if code < accepted - limit:
        return accepted - limit
    return code


@kernel
def shaped_codes(params: ControllerParams, current_a: Triple, sample: Sample, tight_until: int) -> Codes:
    """Codes inside the slew limit in force: the tight one until `tight_until` and for the first samples after the gate opened."""
    limit, opened = params.slew_codes, sample.gate_open_samples
    if (opened < params.tight_samples or sample.number < tight_until) and params.tight_slew_codes < limit:
        limit = params.tight_slew_codes
    accepted = sample.dac_counts
    return (
        slewed_code(params.drive, current_a[0], accepted[0], limit),
        slewed_code(params.drive, current_a[1], accepted[1], limit),
        slewed_code(params.drive, current_a[2], accepted[2], limit),
    )


@kernel
def link_step(
    drive: Drive,
    acting: int,
    takes_over: int,
    held_code: int,
    state: LinkLawState,
    gains: LinkGains,
    law: int,
    q: float,
    q_set: float,
    qd: float,
    qd_set: float,
    load_tau: float,
    dt_s: float,
) -> tuple[LinkLawState, float, int]:
    """Answer of one link's law; of a link that does not act: no current, nothing integrated.

    A law that takes over keeps the current of the code that the D/A holds for this one sample.
    """
    if acting == 0:
        return AT_REST, 0.0, 0
    if takes_over != 0:
        held_a = code_to_current(drive, held_code)
        return take_over(state, gains, law, q, q_set, qd_set, load_tau, held_a), held_a, 0
    state, current_a, boosted = law_step(state, gains, law, q, q_set, qd, qd_set, dt_s)
    return state, current_a + load_feedforward(gains, law, load_tau), boosted


@kernel
def apply_laws(
    params: ControllerParams,
    laws: Laws,
    handover: Handover,
    sample: Sample,
    q: Triple,
    q_set: Triple,
    qd: Triple,
    qd_set: Triple,
    load_tau: Triple,
    dt_s: float,
) -> Actuation:
    """Answer of the three links' position laws."""
    gains, law, on, new, held = params.gains, params.law, params.acting, handover.links, sample.dac_counts
    law_1, u_1, boosted_1 = link_step(
        params.drive, on[0], new & 1, held[0], laws[0], gains[0], law, q[0], q_set[0], qd[0], qd_set[0], load_tau[0], dt_s
    )
    law_2, u_2, boosted_2 = link_step(
        params.drive, on[1], new & 2, held[1], laws[1], gains[1], law, q[1], q_set[1], qd[1], qd_set[1], load_tau[1], dt_s
    )
    law_3, u_3, boosted_3 = link_step(
        params.drive, on[2], new & 4, held[2], laws[2], gains[2], law, q[2], q_set[2], qd[2], qd_set[2], load_tau[2], dt_s
    )
    current_a, boosted = (u_1, u_2, u_3), (boosted_1, boosted_2, boosted_3)
    return Actuation((law_1, law_2, law_3), current_a, boosted, shaped_codes(params, current_a, sample, handover.tight_until))


@kernel
def unload(params: ControllerParams, sample: Sample) -> Actuation:
    """Constant low current with the signs that a recovering gate allows; nothing from any other gate."""
    if sample.gate != GATE_RECOVERING:
        zero = params.drive.zero_code
        return Actuation(LAWS_AT_REST, (0.0, 0.0, 0.0), (0, 0, 0), (zero, zero, zero))
    u, signs = params.recover_current_a, sample.recover_signs
    current_a = (u[0] * signs[0], u[1] * signs[1], u[2] * signs[2])
    return Actuation(LAWS_AT_REST, current_a, (0, 0, 0), shaped_codes(params, current_a, sample, NOTHING_CHANGED.tight_until))


@kernel
def control_step(
    memory: ControlMemory, params: ControllerParams, table: Table, sample: Sample
) -> tuple[ControlMemory, Codes, ControllerState]:
    """Answer one sample: (memory, codes for the D/A, what the law thought). `compute_ns` is 0; the shell fills it."""
    q, pitch_rad = joint_positions(params.calibration, sample.encoder_counts)
    x = forward(params.geometry, q, pitch_rad)
    memory = begin(memory, params, sample, q, x)
    dt_s = (sample.time_ns - memory.trial.time_ns) / NS_PER_S
    trial = advance(memory.trial, sample, q, x)
    raw_n = params.calibration.force_n_per_count * sample.force_counts
    filtered = filter_step(memory.filtered, params.force_cutoff_rad_per_s, params.force_noise_n, raw_n, dt_s)
    force = tare(params, sample.force_counts, memory.force_counts, filtered, trial)
    deltas = reference_deltas(table, sample.trial_time_ns / NS_PER_S if trial.started else BEFORE_START_S)
    running = runs(trial, sample)
    ready = memory.ready
    if running:
        force_set_n = mean_of_three(deltas[6], memory.force_set_n[0], memory.force_set_n[1])
        seen = Seen(q, memory.qd, x, force.mean_n, params.impedance.force_gain * force_set_n)
        wanted = setpoints(params, memory.impedance, memory.explicit, memory.offset, trial, deltas, pitch_rad, seen, dt_s)
    else:
        _, nominal, _ = nominal_joints(params, trial, deltas, pitch_rad)
        wanted = Setpoints(q, x, nominal, rest(x, nominal), FILTERS_AT_REST, Offset(0.0, nominal), 0)
        ready = judge_ready(params, trial, table, q, pitch_rad)
    window = push(memory.window, sample.time_ns, q, wanted.q)
    qd, qd_set = velocities(window)
    if running:
        load_tau = joint_loads(
            params.geometry, q, pitch_rad, params.impedance.force_axis, params.impedance.force_sign * force.mean_n
        )
        made = apply_laws(params, memory.laws, memory.handover, sample, q, wanted.q, qd, qd_set, load_tau, dt_s)
    else:
        made = unload(params, sample)
    thought = ControllerState(
        number=sample.number,
        tick=sample.tick,
        q=q,
        q_set=wanted.q,
        qd=qd,
        qd_set=qd_set,
        x_m=x,
        x_set_m=wanted.x_m,
        x_nominal_m=wanted.nominal_m,
        force_n=force.tared_n,
        force_mean_n=force.mean_n,
        force_set_n=deltas[6],
        force_bias_n=force.bias_n,
        current_a=made.current_a,
        integral_a=(made.laws[0].integral_a, made.laws[1].integral_a, made.laws[2].integral_a),
        boosted=made.boosted,
        clamped=wanted.clamped,
        ready=ready,
        machine_id=params.machine_id,
        compute_ns=0,
    )
    force_counts = (sample.force_counts, memory.force_counts[0])
    force_sets_n = (deltas[6], memory.force_set_n[0])
    impedance, explicit, offset = wanted.impedance, wanted.explicit, wanted.offset
    handover = Handover(0, memory.handover.tight_until)
    memory = ControlMemory(
        trial, window, force_counts, filtered, force_sets_n, impedance, explicit, offset, qd, made.laws, ready, handover
    )
    return memory, made.codes, thought
