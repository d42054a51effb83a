"""What an experiment says about the controller, and its way into the kernels' parameters.

Bounds that one field can state stand beside it; `checks.py` has what only several of them together can say.
"""

import math
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

from annotated_types import Ge, Gt, Le, MinLen

from hydrohil.services.controller.laws.table import LAW_NAMES, law_number
from hydrohil.services.controller.params import (
    ADAPT_LIMIT_SWITCH,
    ADAPT_NONE,
    ADAPT_OFFSET,
    ADAPT_STIFFNESS,
    FORMULATION_MEASURED,
    FORMULATION_SETPOINT,
    FULL_SLEW_CODES,
    TARGET_CARTESIAN,
    TARGET_EXPLICIT,
    TARGET_IMPEDANCE,
    TARGET_JOINT,
    TIGHT_SAMPLES,
    TIGHT_SLEW_CODES,
    AdaptationParams,
    ControllerParams,
    Gains,
    ImpedanceParams,
    LinkGains,
    SetpointScalingParams,
)
from hydrohil.services.controller.reference import CHANNELS, KINDS, Row
from hydrohil.shared.contract.converters import calibration
from hydrohil.shared.contract.messages import PlantDescription
from hydrohil.shared.machine.description import machine_id
from hydrohil.shared.units import A_PER_MA

TARGETS = {"joint": TARGET_JOINT, "cartesian": TARGET_CARTESIAN, "impedance": TARGET_IMPEDANCE, "explicit": TARGET_EXPLICIT}
FORMULATIONS = {"setpoint": FORMULATION_SETPOINT, "measured": FORMULATION_MEASURED}
ADAPTATIONS = {
    "none": ADAPT_NONE,
    "stiffness": ADAPT_STIFFNESS,
    "offset": ADAPT_OFFSET,
    "limit_switch": ADAPT_LIMIT_SWITCH,
}

if TYPE_CHECKING:
    LawName = str
else:
    LawName = Literal[LAW_NAMES]  # a row of `laws/table.py` is all that a new law needs

LONGEST_S = 3600.0  # of a trial; keeps sines inside their domain


class Segment(NamedTuple):
    """One piece of a reference, added to its channel from `start_s` on (rad, m or N by channel)."""

    channel: Literal["q1", "q2", "q3", "x", "y", "z", "force"]
    kind: Literal["step", "ramp", "sine"]
    start_s: Annotated[float, Ge(0), Le(LONGEST_S)] = 0.0  # after tick 0
    duration_s: Annotated[float, Ge(0), Le(LONGEST_S)] = 0.0  # ramp and sine; afterwards the last value stays
    amount: Annotated[float, Ge(-1e4), Le(1e4)] = 0.0  # rad, m or N by channel: height, or a sine's first amplitude
    blend_s: Annotated[float, Ge(0), Le(LONGEST_S)] = 0.0  # ramp: parabolic acceleration at each end, part of duration
    frequency_hz: Annotated[float, Ge(0), Le(50)] = 0.0  # sine
    phase_rad: Annotated[float, Ge(-2 * math.pi), Le(2 * math.pi)] = 0.0  # sine: a (sin(w t + phase) - sin(phase))
    amount_end: Annotated[float, Ge(-1e4), Le(1e4)] | None = None  # sine: amplitude at its end; none = `amount`


Reference = tuple[Segment, ...]


class ScheduledChange(NamedTuple):
    """Parameters that change while the trial runs, in its section [[changes]]."""

    at_s: Annotated[float, Ge(0), Le(LONGEST_S)]  # after tick 0; the first sample at or after it
    set: Annotated[tuple[str, ...], MinLen(1)]  # `path=value` of [controller], as `hydrohil set` takes them


Changes = tuple[ScheduledChange, ...]


class ImpedanceConfig(NamedTuple):
    """Virtual mass, spring and damper that the tool shows to its environment; defaults are the force tests of 5.3."""

    mass_kg: Annotated[float, Gt(0), Le(1e6)] = 500.0
    stiffness_n_per_m: Annotated[float, Gt(0), Le(1e7)] = 50e3
    damping_ratio: Annotated[float, Ge(0), Le(100)] = 1.2
    damping: Literal["model", "net"] = "net"  # xi, or xi_net of model and environment: xi = xi_net sqrt(1 + k_eff / k)
    environment_n_per_m: Annotated[float, Ge(0), Le(1e9)] = 25e3  # estimate of k_eff, plate and sensor in series
    setpoint_compensation: bool = False  # force set-point times (k + k_eff) / k_eff
    formulation: Literal["setpoint", "measured"] = "setpoint"  # whose x and x' damper and spring feel; measured: 6.2.2 (b)
    force_filter: Literal["mean", "butterworth", "bounded"] = "mean"  # of the gauge; bounded: within the noise of the reading
    force_cutoff_hz: Annotated[float, Gt(0), Le(100)] = 0.7  # butterworth, bounded: -3 dB
    force_noise_n: Annotated[float, Gt(0), Le(1e3)] = 10.0  # bounded: the gauge's noise (5.1.2)
    apparent_stiffness_n_per_m: Annotated[float, Gt(0), Le(1e7)] | None = None  # that `stiffness` shows in contact (9.3.2)
    contact_n: Annotated[float, Ge(0), Le(1e3)] = 10.0  # for it: force that confirms contact; the noise stays below


class AdaptationConfig(NamedTuple):
    """How the target impedance gives way as the contact force nears a ceiling (thesis 9.3.4); what each means: adaptation.py."""

    kind: Literal["none", "stiffness", "offset", "limit_switch"] = "none"
    onset_n: Annotated[float, Ge(0), Le(1e4)] = 20.0  # up to it the target is left alone: twice the noise is contact for certain
    ceiling_n: Annotated[float, Gt(0), Le(1e4)] = 100.0  # contact force at which the gains below act in full
    softening_per_s: Annotated[float, Ge(0), Le(1e3)] = 30.0  # stiffness: relative rate of its fall
    retreat_m_per_s: Annotated[float, Ge(0), Le(10)] = 0.7  # offset: speed of the set-point away from the surface
    stop_n: Annotated[float, Ge(0), Le(1e4)] = 800.0  # limit switch: push of the stop
    stop_ns_per_m: Annotated[float, Ge(0), Le(1e6)] = 12e3  # limit switch: damping of the engaged stop
    release_s: Annotated[float, Gt(0), Le(1e3)] = 2.5  # stiffness, offset: time constant of their return


class ActingLinks(NamedTuple):
    """Links that the law drives; the other valves get no current."""

    rotate: bool = True
    down_up: bool = True
    out_in: bool = True


RecoverCurrent = Annotated[float, Ge(0), Le(200 * A_PER_MA)]


class RecoverCurrents(NamedTuple):
    """The valves' currents while a hold-to-run request unloads: each just above the link's worst break-away of Table 2."""

    rotate: RecoverCurrent = 100 * A_PER_MA
    down_up: RecoverCurrent = 125 * A_PER_MA
    out_in: RecoverCurrent = 185 * A_PER_MA


class ControllerConfig(NamedTuple):
    """The [controller] section of an experiment."""

    law: LawName = "final"
    target: Literal["joint", "cartesian", "impedance", "explicit"] = "impedance"  # explicit: force control, equivalent (6.2.1)
    acting: ActingLinks = ActingLinks()
    gains: Gains = Gains()
    impedance: ImpedanceConfig = ImpedanceConfig()
    adaptation: AdaptationConfig = AdaptationConfig()
    slew_codes: Annotated[int, Ge(1), Le(FULL_SLEW_CODES)] = FULL_SLEW_CODES  # per sample
    tight_slew_codes: Annotated[int, Ge(1), Le(FULL_SLEW_CODES)] = TIGHT_SLEW_CODES  # just after the gate opens
    tight_samples: Annotated[int, Ge(0), Le(1000)] = TIGHT_SAMPLES
    recover_current_a: RecoverCurrents = RecoverCurrents()


def impedance_params(config: ImpedanceConfig, force_axis: int, force_sign: float) -> ImpedanceParams:
    """Natural frequency, damping ratio and force gain of the target model (thesis 5.1.3, 5.1.4, 5.3)."""
    k, k_eff = config.stiffness_n_per_m, config.environment_n_per_m
    xi = config.damping_ratio * (math.sqrt(1.0 + k_eff / k) if config.damping == "net" else 1.0)
    gain = (k + k_eff) / k_eff if config.setpoint_compensation else 1.0
    return ImpedanceParams(
        stiffness_n_per_m=float(k),
        natural_frequency_rad_per_s=math.sqrt(k / config.mass_kg),
        damping_ratio=float(xi),
        force_gain=gain,
        force_axis=force_axis,
        force_sign=float(force_sign),
        environment_n_per_m=float(k_eff),
        formulation=FORMULATIONS[config.formulation],
    )


def kernel_gains(gains: LinkGains, target: str) -> LinkGains:
    """The gains as floats, as a compiled kernel takes them; explicit force control has no error dead zone.

    The dead zone ignores what an encoder cannot resolve; the program's `equiv_f_cont` has none, as a force has no counts.
    """
    floats = LinkGains(*(float(gain) for gain in gains))
    return floats._replace(error_dead_zone_q=0.0) if target == "explicit" else floats


def force_cutoff_rad_per_s(config: ImpedanceConfig) -> float:
    """Cutoff of the low-pass on the gauge; 0 leaves it to the mean of three."""
    return 0.0 if config.force_filter == "mean" else 2.0 * math.pi * config.force_cutoff_hz


def adaptation_params(config: AdaptationConfig) -> AdaptationParams:
    """The parameters of the adaptation for the kernels."""
    return AdaptationParams(
        kind=ADAPTATIONS[config.kind],
        onset_n=float(config.onset_n),
        ceiling_n=float(config.ceiling_n),
        softening_per_s=float(config.softening_per_s),
        retreat_m_per_s=float(config.retreat_m_per_s),
        stop_n=float(config.stop_n),
        stop_ns_per_m=float(config.stop_ns_per_m),
        release_s=float(config.release_s),
    )


def setpoint_scaling_params(config: ImpedanceConfig) -> SetpointScalingParams:
    """k_- (k_+ + k_eff) / (k_+ (k_- + k_eff)), the share of each step of the nominal position in contact (thesis 9.3.2)."""
    stiff, soft, k_eff = config.stiffness_n_per_m, config.apparent_stiffness_n_per_m, config.environment_n_per_m
    share = 1.0 if soft is None else soft * (stiff + k_eff) / (stiff * (soft + k_eff))
    return SetpointScalingParams(float(share), float(config.contact_n))


def controller_params(config: ControllerConfig, description: PlantDescription, first_tick: int) -> ControllerParams:
    """Kernel parameters for the machine that `description` describes; the trial begins at the negative `first_tick` (0: none)."""
    recover, acting, gains, target = config.recover_current_a, config.acting, config.gains, config.target
    return ControllerParams(
        law=law_number(config.law),
        target=TARGETS[target],
        acting=(int(acting[0]), int(acting[1]), int(acting[2])),
        gains=(kernel_gains(gains[0], target), kernel_gains(gains[1], target), kernel_gains(gains[2], target)),
        impedance=impedance_params(config.impedance, description.force_axis, description.force_sign),
        force_cutoff_rad_per_s=force_cutoff_rad_per_s(config.impedance),
        force_noise_n=float(config.impedance.force_noise_n) if config.impedance.force_filter == "bounded" else math.inf,
        adaptation=adaptation_params(config.adaptation),
        setpoint_scaling=setpoint_scaling_params(config.impedance),
        machine_id=machine_id(description.machine_hash),
        geometry=description.machine.geometry,
        calibration=calibration(description.machine.encoders, description.machine.force),
        drive=description.machine.drive,
        sample_period_ns=description.sample_period_ns,
        first_tick=first_tick,
        slew_codes=config.slew_codes,
        tight_slew_codes=config.tight_slew_codes,
        tight_samples=config.tight_samples,
        recover_current_a=(float(recover[0]), float(recover[1]), float(recover[2])),
    )


def segment_row(segment: Segment) -> Row:
    """The segment as numbers, in the order of `reference.COLUMNS`."""
    return (
        float(CHANNELS.index(segment.channel)),
        float(KINDS.index(segment.kind)),
        float(segment.start_s),
        float(segment.duration_s),
        float(segment.amount),
        float(segment.blend_s),
        2.0 * math.pi * segment.frequency_hz,
        float(segment.phase_rad),
        float(segment.amount if segment.amount_end is None else segment.amount_end),
    )


def segment_table(reference: Reference) -> tuple[Row, ...]:
    """The reference as rows of floats; a rollout takes the same rows as a float64 array (n, 9)."""
    return tuple(segment_row(segment) for segment in reference)
