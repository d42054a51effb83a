"""Set-points of one sample: what the reference asks, what the target impedance makes of it, and the joints that reach it."""

from typing import NamedTuple

from hydrohil.services.controller.adaptation import adapted_step
from hydrohil.services.controller.alternate import measured_step
from hydrohil.services.controller.explicit import ExplicitState, explicit_step
from hydrohil.services.controller.impedance import ImpedanceState
from hydrohil.services.controller.kinematics import along_axis, clamp_joints, inverse, tip_velocity
from hydrohil.services.controller.params import (
    FORMULATION_MEASURED,
    TARGET_EXPLICIT,
    TARGET_IMPEDANCE,
    TARGET_JOINT,
    ControllerParams,
)
from hydrohil.services.controller.reference import Deltas, Table, reference_deltas
from hydrohil.services.controller.regression import POINTS
from hydrohil.services.controller.setpoint_scaling import Offset, offset_step
from hydrohil.services.controller.trial import Trial
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import NO_TRIAL
from hydrohil.shared.contract.pose import forward
from hydrohil.shared.machine.description import Triple

READY_COUNTS = 2.0 + 1e-6  # the reference may start two counts from the pose; the rest is rounding


class Measured(NamedTuple):
    """What the set-points depend on of one sample."""

    q: Triple
    qd: Triple  # by regression, of the sample before, as in the program
    x_m: Triple
    force_n: float  # mean of three, or low-passed
    force_set_n: float  # mean of three, with its compensation


class Setpoints(NamedTuple):
    """Set-points of one sample."""

    q: Triple
    x_m: Triple
    nominal_m: Triple
    impedance: ImpedanceState
    explicit: ExplicitState
    offset: Offset
    clamped: int


@kernel
def nominal_joints(params: ControllerParams, trial: Trial, deltas: Deltas, pitch_rad: float) -> tuple[Triple, Triple, int]:
    """(q, x, clamp mask) of the reference itself, before the environment yields anything."""
    if params.target == TARGET_JOINT:
        q0 = trial.q_start
        q, clamped = clamp_joints(params.geometry, (q0[0] + deltas[0], q0[1] + deltas[1], q0[2] + deltas[2]))
        return q, forward(params.geometry, q, pitch_rad), clamped
    x0 = trial.x_start_m
    x = (x0[0] + deltas[3], x0[1] + deltas[4], x0[2] + deltas[5])
    q, clamped = inverse(params.geometry, x, pitch_rad)
    return q, x, clamped


@kernel
def setpoints(
    params: ControllerParams,
    impedance: ImpedanceState,
    explicit: ExplicitState,
    offset: Offset,
    trial: Trial,
    deltas: Deltas,
    pitch_rad: float,
    measured: Measured,
    dt_s: float,
) -> Setpoints:
    """Set-points while the law runs: reference, target impedance, inverse kinematics (thesis 5.1.3, steps 1 to 3)."""
    if params.target not in (TARGET_IMPEDANCE, TARGET_EXPLICIT):
        q, x, clamped = nominal_joints(params, trial, deltas, pitch_rad)
        return Setpoints(q=q, x_m=x, nominal_m=x, impedance=impedance, explicit=explicit, offset=offset, clamped=clamped)
    x0, target = trial.x_start_m, params.impedance
    nominal = (x0[0] + deltas[3], x0[1] + deltas[4], x0[2] + deltas[5])
    if params.target == TARGET_EXPLICIT:
        explicit, way_m = explicit_step(explicit, target, measured.force_n, measured.force_set_n, dt_s)
        x = along_axis(measured.x_m, target.force_axis, way_m)
    elif target.formulation == FORMULATION_MEASURED:
        v = tip_velocity(params.geometry, measured.q, pitch_rad, measured.qd)
        impedance, x = measured_step(
            impedance,
            target,
            nominal_m=nominal,
            x_m=measured.x_m,
            v=v,
            force_error_n=measured.force_n - measured.force_set_n,
            dt_s=dt_s,
        )
    else:
        error_n = measured.force_n - measured.force_set_n
        offset = offset_step(offset, params.setpoint_scaling, target.force_axis, nominal, measured.force_n)
        compensated = along_axis(nominal, target.force_axis, -offset.offset_m)
        impedance, x = adapted_step(
            impedance,
            target,
            adaptation=params.adaptation,
            nominal_m=compensated,
            force_n=measured.force_n,
            force_error_n=error_n,
            dt_s=dt_s,
        )
    q, clamped = inverse(params.geometry, x, pitch_rad)
    return Setpoints(q=q, x_m=x, nominal_m=nominal, impedance=impedance, explicit=explicit, offset=offset, clamped=clamped)


@kernel
def within_counts(a: float, b: float, scale: float) -> bool:
    """Whether two positions of a link lie within two encoder counts."""
    return abs((a - b) / scale) <= READY_COUNTS


@kernel
def judge_ready(params: ControllerParams, trial: Trial, table: Table, q: Triple, pitch_rad: float) -> int:
    """1 if 20 samples are in, none was lost, and the reference at tick 0 starts within 2 counts of the measured pose."""
    in_order = trial.whole if trial.started else trial.tick == NO_TRIAL
    if not in_order or trial.samples < POINTS:
        return 0
    start, _, _ = nominal_joints(params, trial, reference_deltas(table, 0.0), pitch_rad)
    scale = params.calibration.scale
    near_1 = within_counts(start[0], q[0], scale[0])
    near_2 = within_counts(start[1], q[1], scale[1])
    near_3 = within_counts(start[2], q[2], scale[2])
    return 1 if near_1 and near_2 and near_3 else 0
