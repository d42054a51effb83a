"""What an emulated hydraulic arm is, in SI, and what it pushes against; the Unimate MKII-2000 with the source of every number.

The suffixes `q` (rad, or m for link 3) and `tau` (N m, or N for link 3) are those of `shared/units.py`.
"""

import math
from typing import Annotated, Literal, NamedTuple

from annotated_types import Ge, Gt, Le, Lt

from hydrohil.shared.machine import unimate
from hydrohil.shared.units import A_PER_MA, GRAVITY_M_PER_S2, RAD_PER_DEG

PA_PER_KPA = 1e3
PA_PER_MPA = 1e6
M3_PER_L = 1e-3

Positive = Annotated[float, Gt(0.0), Lt(math.inf)]
NotNegative = Annotated[float, Ge(0.0), Lt(math.inf)]
Finite = Annotated[float, Gt(-math.inf), Lt(math.inf)]

GEOMETRY, GAUGE = unimate.UNIMATE.geometry, unimate.UNIMATE.gauge  # where its default is what a controller knows of it

AXIS_X, AXIS_Z = 0, 2
FREE, PLATE, CRATE = 0, 1, 2


class LinkParams(NamedTuple):
    """Servo valve, double-acting actuator and friction of one link."""

    displacement_m3_per_q: Positive  # assumed: sets the stall torque; for link 3 the piston area in m2
    dead_volume_m3: Positive  # each side, assumed: ports and hoses; never zero at the ends of travel
    bulk_modulus_pa: Positive  # effective, identified: with hoses and air; sets the P-gain limit and the jumps
    cross_leak_m3_per_s_pa: NotNegative  # laminar, between the chambers, identified from slow break-away currents
    null_leak_m3_per_s_pa: NotNegative  # each land, assumed: centres the mean pressure between supply and return
    full_scale_a: Positive  # current of the full port area: 2048 counts of the D/A
    overlap_a: NotNegative  # spool travel before a port opens (thesis 4.2: 6 % of full scale)
    null_bias_a: Finite  # current that the spool rests at, identified from the unequal break-aways
    flow_gain_m3_per_s_sqrt_pa: Positive  # K_q of the full area: a property of the valve, whatever the supply
    valve_lag_s: Positive  # first order, assumed; results hardly depend on 3..12 ms
    coulomb_tau: NotNegative  # identified
    breakaway_tau: NotNegative  # identified: what holds a link that stands
    stribeck_q_per_s: Positive  # identified: speed at which break-away has fallen to Coulomb friction by 1/e
    viscous_tau_s_per_q: NotNegative  # assumed
    travel_low_q: Finite  # program of Appendix F
    travel_high_q: Finite  # program of Appendix F
    area_ratio: Annotated[float, Ge(0.1), Le(10.0)] = 1.0  # area of chamber B / of A, Db / Da: equal areas (thesis 3.2.1)


class MachineParams(NamedTuple):
    """The hydraulic manipulator with its supply, arm geometry and force gauge."""

    rotate: LinkParams
    down_up: LinkParams
    out_in: LinkParams
    supply_pressure_pa: Annotated[float, Gt(0.0), Le(35.0 * PA_PER_MPA)] = 7000.0 * PA_PER_KPA  # a machine has its own band
    return_pressure_pa: NotNegative = 0.0  # assumed
    root_smoothing_pa: Positive = 20.0 * PA_PER_KPA  # numerics: the orifice is laminar below this drop
    boom_mass_kg: Positive = 45.0  # assumed: what link 3 moves
    boom_centre_m: Finite = 0.7  # assumed: centre of mass behind the tip
    inertia_rotate_kg_m2: Positive = 250.0  # assumed, without the arm: 361 kg m2 in all at 1 m
    inertia_down_up_kg_m2: Positive = 107.0  # assumed, without the boom: 111 kg m2 in all at 1 m
    counterbalance_kg_m: Finite = 7.8  # identified: leaves 56 N m at 1 m and 421 N m fully out, both down
    a2_m: Finite = GEOMETRY.offset_m
    a4_m: Finite = GEOMETRY.hand_m  # length of the tool
    q4_rad: Finite = 0.0  # assumed: tool straight down
    d3_offset_m: Finite = GEOMETRY.retracted_m
    sensor_stiffness_n_per_m: Positive = GAUGE.stiffness_n_per_m
    sensor_damping_ns_per_m: NotNegative = GAUGE.damping_ns_per_m  # assumed: a loose gripper, damping ratio 0.17 with the crate
    force_bias_n: Finite = 30.0  # assumed: what the gauge reads unloaded, to be tared
    force_noise_sigma_n: NotNegative = 5.0  # thesis: +-10 N peak
    force_noise_clip_n: NotNegative = GAUGE.noise_n
    force_low_n: Finite = 0.0  # thesis: range of the gauge's amplifier
    force_high_n: Finite = GAUGE.range_n


UNIMATE_PARAMS = MachineParams(
    rotate=LinkParams(
        displacement_m3_per_q=1.0 * M3_PER_L,  # stalls at 7.0 kN m
        dead_volume_m3=0.4 * M3_PER_L,
        bulk_modulus_pa=320.0 * PA_PER_MPA,
        cross_leak_m3_per_s_pa=1.1e-11,  # 4.6 L/min at 7 MPa: a worn machine of 20 years
        null_leak_m3_per_s_pa=1e-13,
        full_scale_a=600.0 * A_PER_MA,
        overlap_a=36.0 * A_PER_MA,
        null_bias_a=0.0 * A_PER_MA,
        flow_gain_m3_per_s_sqrt_pa=6.7846e-7,  # 24 deg/s at 360 mA without load, friction, leak and bias
        valve_lag_s=0.006,
        coulomb_tau=220.0,
        breakaway_tau=450.0,
        stribeck_q_per_s=1.0 * RAD_PER_DEG,
        viscous_tau_s_per_q=1500.0,
        travel_low_q=GEOMETRY.low_q[0],
        travel_high_q=GEOMETRY.high_q[0],
    ),
    down_up=LinkParams(
        displacement_m3_per_q=0.64 * M3_PER_L,  # stalls at 4.5 kN m
        dead_volume_m3=0.3 * M3_PER_L,
        bulk_modulus_pa=320.0 * PA_PER_MPA,
        cross_leak_m3_per_s_pa=1.0e-11,  # 4.2 L/min at 7 MPa
        null_leak_m3_per_s_pa=1e-13,
        full_scale_a=600.0 * A_PER_MA,
        overlap_a=36.0 * A_PER_MA,
        null_bias_a=8.0 * A_PER_MA,  # 1.3 % of full scale
        flow_gain_m3_per_s_sqrt_pa=3.7994e-7,  # 21 deg/s at 360 mA without load, friction, leak and bias
        valve_lag_s=0.006,
        coulomb_tau=170.0,
        breakaway_tau=470.0,
        stribeck_q_per_s=1.0 * RAD_PER_DEG,
        viscous_tau_s_per_q=700.0,
        travel_low_q=GEOMETRY.low_q[1],
        travel_high_q=GEOMETRY.high_q[1],
    ),
    out_in=LinkParams(
        displacement_m3_per_q=1.4e-3,  # m2; stalls at 9.8 kN
        dead_volume_m3=0.4 * M3_PER_L,
        bulk_modulus_pa=320.0 * PA_PER_MPA,
        cross_leak_m3_per_s_pa=2.0e-11,  # 8.4 L/min at 7 MPa
        null_leak_m3_per_s_pa=1e-13,
        full_scale_a=600.0 * A_PER_MA,
        overlap_a=90.0 * A_PER_MA,  # 15 %: 6 % cannot give the 141 and 176 mA of Table 2
        null_bias_a=17.0 * A_PER_MA,  # 2.8 % of full scale
        flow_gain_m3_per_s_sqrt_pa=1.01459e-6,  # 0.38 m/s at 360 mA without load, friction, leak and bias
        valve_lag_s=0.006,
        coulomb_tau=900.0,
        breakaway_tau=1300.0,
        stribeck_q_per_s=0.010,
        viscous_tau_s_per_q=900.0,
        travel_low_q=GEOMETRY.low_q[2],
        travel_high_q=GEOMETRY.high_q[2],
    ),
)


class Environment(NamedTuple):
    """What the tool meets: nothing, a plate below that bends, or a crate in front that slides."""

    kind: Literal["free", "plate", "crate"] = "free"
    stiffness_n_per_m: Positive = 7208.0  # of the plate, 48 E I / L^3: 7208 at 27.25 in, 53150 at 14 in (Appendix D)
    surface_m: Finite = 0.0  # height z of the unbent plate; x of the crate's near face
    crate_mass_kg: Positive = 64.0  # thesis 5.5
    crate_static_friction: NotNegative = 0.37  # thesis 5.5
    crate_kinetic_friction: NotNegative = 0.29  # thesis 5.5


class ContactParams(NamedTuple):
    """The environment in the numbers that a sub-step needs."""

    kind: int  # FREE, PLATE or CRATE
    force_axis: int  # direction of the gauge: AXIS_X or AXIS_Z
    force_sign: float  # direction of the environment's push on the tool along that axis
    stiffness_n_per_m: float
    surface_m: float
    mass_kg: float
    breakaway_n: float  # friction under the standing crate
    sliding_n: float  # friction under the sliding crate


def contact_params(environment: Environment) -> ContactParams:
    """The environment as a sub-step sees it; ValueError if a crate would stick less than it slides."""
    static, kinetic = environment.crate_static_friction, environment.crate_kinetic_friction
    if static < kinetic:
        raise ValueError(f"crate_static_friction is {static:g}; expected at least crate_kinetic_friction, {kinetic:g}")
    kind = {"free": FREE, "plate": PLATE, "crate": CRATE}[environment.kind]
    weight_n = environment.crate_mass_kg * GRAVITY_M_PER_S2
    return ContactParams(
        kind=kind,
        force_axis=AXIS_X if kind == CRATE else AXIS_Z,
        force_sign=-1.0 if kind == CRATE else 1.0,
        stiffness_n_per_m=environment.stiffness_n_per_m,
        surface_m=environment.surface_m,
        mass_kg=environment.crate_mass_kg,
        breakaway_n=static * weight_n,
        sliding_n=kinetic * weight_n,
    )
