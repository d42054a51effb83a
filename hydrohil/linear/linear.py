"""The linearised model of thesis 3.2 in one direction of the tip: what the plant's parameters are at an operating point.

The tool moves along the gauge's axis by one link at a lever r: link 2 on the plate and in free space, link 3 at the crate.
X is positive towards the environment, F its push back, T the actuator's force at the tip: all in m and N.
"""

import math
from typing import NamedTuple

from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import ControllerConfig, LinkGains, MachineParams, PlantConfig, latch_substeps
from hydrohil.services.controller.config import impedance_params
from hydrohil.services.plant.hydraulics import port_area, signed_root
from hydrohil.services.plant.mechanism import inertias, posture
from hydrohil.services.plant.params import LinkParams
from hydrohil.shared.units import A_PER_MA, SUBSTEP_S

DOWN_UP, OUT_IN = 1, 2
DEFAULT_SPOOL_A = 120.0 * A_PER_MA  # just beyond every break-away current of link 2 (Table 2): slow motion


class OperatingPoint(NamedTuple):
    """Where the orifice is linearised: spool position as a current, null bias included, and load pressure Pa - Pb."""

    spool_a: float = DEFAULT_SPOOL_A
    load_pa: float = 0.0


SLOW_MOTION = OperatingPoint()


class Actuator(NamedTuple):
    """Valve and piston seen from the tip:  C/2 P' = K_x u - G P - A_p x',  T = A_p P."""

    area_m2: float  # A_p = D / r
    flow_m3_per_s_a: float  # K_x
    leak_m3_per_s_pa: float  # G: half of the orifice's K_pi, and the leaks, which the thesis leaves out
    half_compressibility_m3_per_pa: float  # C / 2 = 1 / (beta (1 / Va + 1 / Vb))


class Arm(NamedTuple):
    """Robot, gauge and environment of Figure 3-10; an environment of stiffness, damping and mass 0 is free motion."""

    mass_kg: float  # m_A
    damping_ns_per_m: float  # c_r
    stiffness_n_per_m: float  # k_r
    sensor_stiffness_n_per_m: float  # k_s
    sensor_damping_ns_per_m: float  # c_s
    environment_mass_kg: float  # m_B
    environment_damping_ns_per_m: float  # c_e
    environment_stiffness_n_per_m: float  # k_e


class Target(NamedTuple):
    """Target impedance; F_d enters times `force_gain` (5.3)."""

    mass_kg: float
    damping_ns_per_m: float
    stiffness_n_per_m: float
    force_gain: float
    feels_measured: bool = False  # damper and spring feel X, not X_s: the alternate formulation (b) of 6.2.2
    filter_rad_per_s: float = 0.0  # second-order Butterworth on the gauge (9.3.1); 0 = none


class Position(NamedTuple):
    """Position controller at the tip and what lies between it and the spool."""

    proportional_a_per_m: float
    integral_a_per_m_s: float
    delay_s: float  # latch and half a sampling period; 0 in the thesis
    spool_lag_s: float  # 0 in the thesis


class LinearModel(NamedTuple):
    """Everything that the transfer functions of 3.2.1 are made of."""

    actuator: Actuator
    arm: Arm
    target: Target
    position: Position

    def as_in_the_thesis(self) -> "LinearModel":
        """The model without delay and spool dynamics (3.2.1: "fast enough to be negligible")."""
        return self._replace(position=self.position._replace(delay_s=0.0, spool_lag_s=0.0))


def port_slope_per_a(link: LinkParams, spool_a: float) -> float:
    """da/dx of the parabolic port with overlap,  2 (|x| - u0) / (full scale - u0)^2  (4.2); 0 inside the overlap."""
    open_a = abs(spool_a) - link.overlap_a
    width_a = link.full_scale_a - link.overlap_a
    return 2.0 * open_a / (width_a * width_a) if open_a > 0.0 else 0.0


def actuator(machine: MachineParams, link: LinkParams, q: float, lever_m: float, point: OperatingPoint) -> Actuator:
    """The orifice equation  Q = K_q a(x) sqrt((Ps - Pr - P) / 2)  linearised at `point`. ValueError if the port is shut.

    K_x = dQ/dx and -dQ/dP = K_pi / 2, where K_pi is the thesis' derivative by the drop over one port: each port sees half
    of the load pressure (the thesis prints K_pi).
    """
    if abs(point.spool_a) <= link.overlap_a:
        ma, overlap = point.spool_a / A_PER_MA, link.overlap_a / A_PER_MA
        raise ValueError(f"the port is shut at {ma:g} mA and passes nothing: take more than its overlap of {overlap:g} mA")
    drop_pa = (machine.supply_pressure_pa - machine.return_pressure_pa - point.load_pa) / 2.0
    if drop_pa <= 0.0:
        raise ValueError(f"load_pa is {point.load_pa:g} Pa: the actuator stalls; expected less than the supply")
    root = signed_root(drop_pa, machine.root_smoothing_pa)
    flow = link.flow_gain_m3_per_s_sqrt_pa * abs(port_area(link, point.spool_a)) * root
    if link.area_ratio != 1.0:
        raise ValueError(f"area_ratio is {link.area_ratio:g}: the linear model has equal piston areas; expected 1")
    displacement = link.displacement_m3_per_q
    volume_a = link.dead_volume_m3 + displacement * (q - link.travel_low_q)
    volume_b = link.dead_volume_m3 + displacement * (link.travel_high_q - q)
    return Actuator(
        area_m2=displacement / lever_m,
        flow_m3_per_s_a=link.flow_gain_m3_per_s_sqrt_pa * port_slope_per_a(link, point.spool_a) * root,
        leak_m3_per_s_pa=flow / (4.0 * drop_pa) + link.cross_leak_m3_per_s_pa + link.null_leak_m3_per_s_pa,
        half_compressibility_m3_per_pa=1.0 / (link.bulk_modulus_pa * (1.0 / volume_a + 1.0 / volume_b)),
    )


def arm(plant: PlantConfig, index: int, lever_m: float) -> Arm:
    """Inertia and viscous friction of the link at the tip, gauge and environment. Dry friction has no linear counterpart."""
    machine, environment = plant.machine, plant.environment
    link = (machine.rotate, machine.down_up, machine.out_in)[index]
    inertia = inertias(machine, posture(machine, plant.initial_q))[index]
    square = lever_m * lever_m
    kind = environment.kind
    return Arm(
        mass_kg=inertia / square,
        damping_ns_per_m=link.viscous_tau_s_per_q / square,
        stiffness_n_per_m=0.0,
        sensor_stiffness_n_per_m=machine.sensor_stiffness_n_per_m,
        sensor_damping_ns_per_m=machine.sensor_damping_ns_per_m,
        environment_mass_kg=environment.crate_mass_kg if kind == "crate" else 0.0,  # the emulated plate has none
        environment_damping_ns_per_m=0.0,
        environment_stiffness_n_per_m=environment.stiffness_n_per_m if kind == "plate" else 0.0,
    )


def target(config: ControllerConfig) -> Target:
    """c = 2 xi sqrt(m k) with the xi that the controller uses. The mean of three readings, 4.5 ms late, is left out.

    A bounded filter is its low-pass as long as the force changes by less than the gauge's noise, and only there: what the
    model has growing ends at that size.
    """
    impedance = config.impedance
    cutoff = 0.0 if impedance.force_filter == "mean" else 2.0 * math.pi * impedance.force_cutoff_hz
    params = impedance_params(impedance, 2, 1.0)
    k = params.stiffness_n_per_m
    m = k / (params.natural_frequency_rad_per_s * params.natural_frequency_rad_per_s)
    c = 2.0 * params.damping_ratio * params.natural_frequency_rad_per_s * m
    return Target(
        mass_kg=m,
        damping_ns_per_m=c,
        stiffness_n_per_m=k,
        force_gain=params.force_gain,
        feels_measured=impedance.formulation == "measured",
        filter_rad_per_s=cutoff,
    )


def position(gains: LinkGains, law: str, plant: PlantConfig, link: LinkParams, lever_m: float) -> Position:
    """PI of Table 2 at the tip. The nonlinear laws are their K_I alone: at rest their factor is 1 and nothing boosts."""
    integral = gains.linear_ki_a_per_q_s if law == "pi" else gains.ki_a_per_q_s
    delay_s = SUBSTEP_S * (latch_substeps(plant) + plant.sample_period_substeps / 2.0)
    return Position(gains.kp_a_per_q / lever_m, integral / lever_m, delay_s, link.valve_lag_s)


def linear_model(experiment: Experiment, point: OperatingPoint = SLOW_MOTION) -> LinearModel:
    """The model of an impedance experiment. ValueError for what it has no term for, or a shut port."""
    config = experiment.controller
    if config.target != "impedance":
        raise ValueError(f"controller.target is {config.target}: the linear model needs impedance")
    if config.law == "torque":
        raise ValueError("controller.law is torque: the linear model has no load fed forward; take final")
    if config.adaptation.kind != "none":
        kind = config.adaptation.kind
        raise ValueError(f"controller.adaptation.kind is {kind}: the linear model's target is constant; take none")
    plant, machine = experiment.plant, experiment.plant.machine
    index = OUT_IN if plant.environment.kind == "crate" else DOWN_UP
    link = (machine.rotate, machine.down_up, machine.out_in)[index]
    lever_m = 1.0 if index == OUT_IN else posture(machine, plant.initial_q).reach_m
    return LinearModel(
        actuator(machine=machine, link=link, q=plant.initial_q[index], lever_m=lever_m, point=point),
        arm(plant, index, lever_m),
        target(experiment.controller),
        position(experiment.controller.gains[index], experiment.controller.law, plant, link, lever_m),
    )
