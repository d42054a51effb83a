"""Gains of the position laws (thesis Table 2 and the program of Appendix F) and what the controller's kernels need.

The suffixes `q` (rad, or m for link 3) and `tau` (N m, or N for link 3) are those of `shared/units.py`.
"""

from typing import Annotated, NamedTuple

from annotated_types import Ge, Gt

from hydrohil.shared.contract.converters import Calibration
from hydrohil.shared.machine.description import Drive, Geometry, Triple
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.units import A_PER_MA, A_PER_RAD_PER_MA_PER_DEG, RAD_PER_DEG

A_PER_COUNT = 1.0 / UNIMATE.drive.counts_per_a  # the program's thresholds are in counts, 2048 of them are 360 mA
SQUARE_RAD_PER_DEG = RAD_PER_DEG * RAD_PER_DEG

TARGET_JOINT, TARGET_CARTESIAN, TARGET_IMPEDANCE, TARGET_EXPLICIT = 0, 1, 2, 3
FORMULATION_SETPOINT, FORMULATION_MEASURED = 0, 1
ADAPT_NONE, ADAPT_STIFFNESS, ADAPT_OFFSET, ADAPT_LIMIT_SWITCH = 0, 1, 2, 3

FULL_SLEW_CODES = UNIMATE.converters[0].high - UNIMATE.converters[0].low  # the thesis limits nothing: full swing in one sample
TIGHT_SLEW_CODES = 100  # 29 mA, inside the valve's overlap of 36 mA
TIGHT_SAMPLES = 20  # until the regression holds samples of the running law alone


class LinkGains(NamedTuple):
    """Gains of one link's position law; defaults are link 2, the one that the thesis tuned on."""

    kp_a_per_q: Annotated[float, Ge(0)] = 215 * A_PER_RAD_PER_MA_PER_DEG  # K_P, Table 2
    ki_a_per_q_s: Annotated[float, Ge(0)] = 1151 * A_PER_RAD_PER_MA_PER_DEG  # K_I of the nonlinear laws, Table 2
    linear_ki_a_per_q_s: Annotated[float, Ge(0)] = 115 * A_PER_RAD_PER_MA_PER_DEG  # K_I of the linear PI law, 4.3
    alpha_max_q2_per_s2: Annotated[float, Gt(0)] = 8000 * SQUARE_RAD_PER_DEG  # Table 2
    qd_max_q_per_s: Annotated[float, Gt(0)] = 10 * RAD_PER_DEG  # Table 2
    error_dead_zone_q: Annotated[float, Ge(0)] = 2 * 0.03 * RAD_PER_DEG  # 2 minerr, 2.1 encoder counts
    dead_zone_speed_q_per_s: Annotated[float, Ge(0)] = 0.03 * RAD_PER_DEG  # minerr, compared with deg/s
    stiction_rate_min_q_per_s: Annotated[float, Ge(0)] = 0.15 * RAD_PER_DEG  # e_min, Table 2
    stiction_selectivity: Annotated[float, Ge(0)] = 50.0  # beta, Table 2
    stiction_epsilon_q2_per_s2: Annotated[float, Gt(0)] = 1e-4 * SQUARE_RAD_PER_DEG  # Appendix F, against 0/0
    boost_below_a: Annotated[float, Ge(0)] = 450 * A_PER_COUNT  # deadcomp: boost only if the current is weaker, 79 mA
    boost_positive_a: Annotated[float, Ge(0)] = 88 * A_PER_MA  # U_lower, moves down or out, Table 2
    boost_negative_a: Annotated[float, Ge(0)] = 114 * A_PER_MA  # U_upper, moves up or in, Table 2
    ka_a_s_per_q: Annotated[float, Ge(0)] = 26.4 * A_PER_RAD_PER_MA_PER_DEG  # K_a: 150 counts s/deg of the program
    braking_clip_q_per_s2: Annotated[float, Ge(0)] = 100 * RAD_PER_DEG  # maxacc, Appendix F
    deadband_width_a: Annotated[float, Gt(0)] = 7 * A_PER_MA  # U_L, 4.5.1
    deadband_positive_a: Annotated[float, Ge(0)] = 88 * A_PER_MA  # U+, 4.5.1
    deadband_negative_a: Annotated[float, Ge(0)] = 88 * A_PER_MA  # -U-, 4.5.1
    hysteresis_a: Annotated[float, Ge(0)] = 7 * A_PER_MA  # half width of the relay; the thesis' text is lost, U_L taken
    braking_least_a: Annotated[float, Ge(0)] = 450 * A_PER_COUNT  # U_b of the robust law: deadcomp, too weak to move
    load_feedforward_a_per_tau: Annotated[float, Ge(0)] = 0.068 * A_PER_MA  # k_tau of the torque law, see below


# Table 2 prints K_a of link 2 as 150, which is the program's 150 counts s/deg left unconverted: 26.4 mA s/deg as link 1.
# The linear law's K_I is printed for link 2 alone (115, a tenth of 1151); links 1 and 3 are scaled by a tenth likewise.
# U+ and U- are printed for link 2 alone (88 mA); links 1 and 3 take their VETIA currents of Table 2.
# k_tau is what a load takes off the current at which a link breaks loose, as found on a real machine with a weight: slow ramps
# of 10 mA/s on the emulated one, between loads of -+250 N m on links 1 and 2 and of -+500 N on link 3.
ROTATE_GAINS = LinkGains(
    kp_a_per_q=92 * A_PER_RAD_PER_MA_PER_DEG,
    ki_a_per_q_s=613 * A_PER_RAD_PER_MA_PER_DEG,
    linear_ki_a_per_q_s=61.3 * A_PER_RAD_PER_MA_PER_DEG,
    alpha_max_q2_per_s2=5000 * SQUARE_RAD_PER_DEG,
    boost_negative_a=88 * A_PER_MA,
    braking_clip_q_per_s2=15 * RAD_PER_DEG,
    load_feedforward_a_per_tau=0.043 * A_PER_MA,
)
DOWN_UP_GAINS = LinkGains()
OUT_IN_GAINS = LinkGains(
    kp_a_per_q=17600 * A_PER_MA,
    ki_a_per_q_s=65900 * A_PER_MA,
    linear_ki_a_per_q_s=6590 * A_PER_MA,
    alpha_max_q2_per_s2=20.0,
    qd_max_q_per_s=0.2,
    error_dead_zone_q=2 * 0.00105,
    dead_zone_speed_q_per_s=0.00105,
    stiction_rate_min_q_per_s=0.0015,
    stiction_epsilon_q2_per_s2=1e-4,  # the program's number in m2/s2: the boost triggers at 5.9 mm/s, not at 1.5
    boost_below_a=650 * A_PER_COUNT,
    boost_positive_a=141 * A_PER_MA,
    boost_negative_a=176 * A_PER_MA,
    ka_a_s_per_q=3520 * A_PER_MA,
    braking_clip_q_per_s2=0.05,
    deadband_positive_a=141 * A_PER_MA,
    deadband_negative_a=176 * A_PER_MA,
    braking_least_a=650 * A_PER_COUNT,
    load_feedforward_a_per_tau=0.022 * A_PER_MA,
)


class Gains(NamedTuple):
    """Gains of each link."""

    rotate: LinkGains = ROTATE_GAINS
    down_up: LinkGains = DOWN_UP_GAINS
    out_in: LinkGains = OUT_IN_GAINS


UNIMATE_GAINS = Gains()


class ImpedanceParams(NamedTuple):
    """Target impedance  m x'' + c (x' - xd') + k (x - xd) = sign (f - gain fd),  c = 2 xi sqrt(m k)."""

    stiffness_n_per_m: float
    natural_frequency_rad_per_s: float
    damping_ratio: float
    force_gain: float  # set-point compensation (k + k_eff) / k_eff; 1 = none
    force_axis: int  # 0 = x, 2 = z
    force_sign: float  # direction in which the environment pushes the tool along that axis
    environment_n_per_m: float = 0.0  # k_eff; only the equivalent explicit controller needs it
    formulation: int = FORMULATION_SETPOINT


class SetpointScalingParams(NamedTuple):
    """Set-point compensation for position: what a stiff target's nominal position does of each step while in contact."""

    share: float = 1.0  # 1 = all of it, no compensation
    contact_n: float = 0.0  # above it the gauge confirms contact


class AdaptationParams(NamedTuple):
    """How the target gives way between an onset and a ceiling of the contact force."""

    kind: int
    onset_n: float
    ceiling_n: float
    softening_per_s: float  # relative rate at which the stiffness falls at the ceiling
    retreat_m_per_s: float  # speed at which the set-point leaves the surface at the ceiling
    stop_n: float  # push of the stop at the ceiling
    stop_ns_per_m: float  # damping of the model's motion while the stop is engaged
    release_s: float  # time constant of the return below the onset


class ControllerParams(NamedTuple):
    """Everything that the controller's kernels need beside the reference."""

    law: int  # its place in `laws/table.py`
    target: int
    acting: tuple[int, int, int]  # 1 = the link's law drives its valve, 0 = no current
    gains: tuple[LinkGains, LinkGains, LinkGains]
    impedance: ImpedanceParams
    force_cutoff_rad_per_s: float  # of the low-pass on the gauge; 0 = mean of three samples
    force_noise_n: float  # how far the low-pass may be off the reading
    adaptation: AdaptationParams
    setpoint_scaling: SetpointScalingParams
    machine_id: int  # of the machine that all of this is for
    geometry: Geometry
    calibration: Calibration
    drive: Drive
    sample_period_ns: int  # nominal; only fills the regression before the first samples
    first_tick: int  # of the trial, negative: the force bias is averaged from here to tick 0; 0 = no trial loaded
    slew_codes: int  # per sample, against the code last accepted
    tight_slew_codes: int
    tight_samples: int  # since the gate opened
    recover_current_a: Triple
