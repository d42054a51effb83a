"""The controller: one sample in, three D/A codes out (thesis 5.1.3 around chapter 4; `joystick_manipulate` of Appendix F).

While the gate is shut the controller tracks: set-point = measured, integrals 0, target model at rest, codes zero.
The law runs at tick 0, whose sample cannot yet report the gate that this very answer opens, and while the gate is open.
"""

from typing import NamedTuple

from hydrohil.services.controller.actuation import (
    LAWS_AT_REST,
    NOTHING_CHANGED,
    Codes,
    Handover,
    JointMotion,
    Laws,
    apply_laws,
    unload,
)
from hydrohil.services.controller.explicit import FILTERS_AT_REST, ExplicitState
from hydrohil.services.controller.filtering import Filtered, filter_step
from hydrohil.services.controller.impedance import ImpedanceState, mean_of_three, rest
from hydrohil.services.controller.kinematics import joint_loads
from hydrohil.services.controller.params import ControllerParams
from hydrohil.services.controller.reference import Table, reference_deltas
from hydrohil.services.controller.regression import Window, filled_window, push, velocities
from hydrohil.services.controller.setpoint import Measured, Setpoints, judge_ready, nominal_joints, setpoints
from hydrohil.services.controller.setpoint_scaling import Offset
from hydrohil.services.controller.trial import Trial, advance, begun_trial, follows, runs
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import NO_TRIAL, ControllerState, Sample
from hydrohil.shared.contract.pose import forward, joint_positions
from hydrohil.shared.machine.description import Triple
from hydrohil.shared.units import NS_PER_S

BEFORE_START_S = -1.0  # reference time outside a trial: no segment has begun


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


def control_start(params: ControllerParams) -> ControlMemory:
    """Memory of a controller before its first sample, which fills it."""
    origin = (0.0, 0.0, 0.0)
    trial = begun_trial(-1, NO_TRIAL, 0, False, origin, origin)
    window = filled_window(0, origin, params.sample_period_ns)
    return at_rest(trial, window, (0, 0), Filtered(0.0, 0.0), origin)


@kernel
def at_rest(trial: Trial, window: Window, force_counts: tuple[int, int], filtered: Filtered, x: Triple) -> ControlMemory:
    """Memory of a controller whose laws and target stand at `x` and that has heard of no set-point."""
    return ControlMemory(
        trial=trial,
        window=window,
        force_counts=force_counts,
        filtered=filtered,
        force_set_n=(0.0, 0.0),
        impedance=rest(x, x),
        explicit=FILTERS_AT_REST,
        offset=Offset(0.0, x),
        qd=(0.0, 0.0, 0.0),
        laws=LAWS_AT_REST,
        ready=0,
        handover=NOTHING_CHANGED,
    )


@kernel
def begin(memory: ControlMemory, params: ControllerParams, sample: Sample, q: Triple, x: Triple) -> ControlMemory:
    """Memory before this sample: everything starts anew at a trial's first tick and wherever the samples do not follow."""
    first = sample.tick == params.first_tick and sample.tick < 0
    if not first and follows(memory.trial, sample):
        return memory
    trial = begun_trial(sample.number, sample.tick, sample.time_ns, first, q, x)
    window = filled_window(sample.time_ns - params.sample_period_ns, q, params.sample_period_ns)
    counts = (sample.force_counts, sample.force_counts)
    filtered = Filtered(params.calibration.force_n_per_count * sample.force_counts, 0.0)
    return at_rest(trial, window, counts, filtered, x)


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
def control_step(
    memory: ControlMemory, params: ControllerParams, table: Table, sample: Sample
) -> tuple[ControlMemory, Codes, ControllerState]:
    """Answer one sample: (memory, codes for the D/A, the state that it publishes). `compute_ns` is 0; the shell fills it."""
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
        measured = Measured(q=q, qd=memory.qd, x_m=x, force_n=force.mean_n, force_set_n=params.impedance.force_gain * force_set_n)
        setpoint = setpoints(
            params,
            impedance=memory.impedance,
            explicit=memory.explicit,
            offset=memory.offset,
            trial=trial,
            deltas=deltas,
            pitch_rad=pitch_rad,
            measured=measured,
            dt_s=dt_s,
        )
    else:
        _, nominal, _ = nominal_joints(params, trial, deltas, pitch_rad)
        setpoint = Setpoints(
            q=q,
            x_m=x,
            nominal_m=nominal,
            impedance=rest(x, nominal),
            explicit=FILTERS_AT_REST,
            offset=Offset(0.0, nominal),
            clamped=0,
        )
        ready = judge_ready(params, trial, table, q, pitch_rad)
    window = push(memory.window, sample.time_ns, q, setpoint.q)
    qd, qd_set = velocities(window)
    if running:
        load_tau = joint_loads(
            params.geometry, q, pitch_rad, params.impedance.force_axis, params.impedance.force_sign * force.mean_n
        )
        motion = JointMotion(q=q, q_set=setpoint.q, qd=qd, qd_set=qd_set, load_tau=load_tau)
        actuation = apply_laws(params, memory.laws, memory.handover, sample, motion, dt_s)
    else:
        actuation = unload(params, sample)
    answer = ControllerState(
        number=sample.number,
        tick=sample.tick,
        q=q,
        q_set=setpoint.q,
        qd=qd,
        qd_set=qd_set,
        x_m=x,
        x_set_m=setpoint.x_m,
        x_nominal_m=setpoint.nominal_m,
        force_n=force.tared_n,
        force_mean_n=force.mean_n,
        force_set_n=deltas[6],
        force_bias_n=force.bias_n,
        current_a=actuation.current_a,
        integral_a=(actuation.laws[0].integral_a, actuation.laws[1].integral_a, actuation.laws[2].integral_a),
        boosted=actuation.boosted,
        clamped=setpoint.clamped,
        ready=ready,
        machine_id=params.machine_id,
        compute_ns=0,
    )
    memory = ControlMemory(
        trial=trial,
        window=window,
        force_counts=(sample.force_counts, memory.force_counts[0]),
        filtered=filtered,
        force_set_n=(deltas[6], memory.force_set_n[0]),
        impedance=setpoint.impedance,
        explicit=setpoint.explicit,
        offset=setpoint.offset,
        qd=qd,
        laws=actuation.laws,
        ready=ready,
        handover=Handover((0, 0, 0), memory.handover.tight_until),
    )
    return memory, actuation.codes, answer
