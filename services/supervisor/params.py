"""The supervisor's parameters for one trial, from its section, the plant's description and the trial's length."""

import math

from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.services.supervisor.observe import ObserverParams
from hydrohil.services.supervisor.observe_motion import DriveCodes
from hydrohil.services.supervisor.rule import Limits
from hydrohil.services.supervisor.state import SupervisorParams
from hydrohil.shared.contract.converters import calibration
from hydrohil.shared.contract.deadline_window import missed_limit
from hydrohil.shared.contract.messages import PlantDescription
from hydrohil.shared.machine.description import MachineDescription
from hydrohil.shared.transport.protection import FAULTS_PER_S
from hydrohil.shared.units import NS_PER_S

QUIET_NS = 100_000_000  # a gauge without its noise is found within this
FEWEST_QUIET = 16  # readings in a row that a gauge that works gives once in 1e10
_LEAD_S, _ARMED_S, _RECOVER_S = 0.25, 60.0, 0.3


def supervisor_params(
    config: SupervisorConfig, description: PlantDescription, tare_ticks: int, duration_ticks: int
) -> SupervisorParams:
    """Everything the supervisor's step needs."""

    def samples(seconds: float) -> int:
        return int(seconds * NS_PER_S) // description.sample_period_ns

    return SupervisorParams(
        limits(config, description),
        observer_params(config, description, tare_ticks),
        duration_ticks,
        samples(_LEAD_S),
        samples(_ARMED_S),
        samples(_RECOVER_S),
    )


def limits(config: SupervisorConfig, description: PlantDescription) -> Limits:
    """What the rules judge against."""
    machine = description.machine
    rotate, down_up, out_in, _, pitch = machine.encoders
    lease_samples = description.permit_ttl_ns // description.sample_period_ns
    return Limits(
        config=config,
        gauge=machine.gauge,
        motion=machine.motion,
        min_force_counts=0,
        max_force_counts=int(machine.gauge.range_n / machine.force.scale),
        quiet_samples=_quiet_samples(description),
        low_counts=(rotate.low, down_up.low, out_in.low),
        high_counts=(rotate.high, down_up.high, out_in.high),
        count_q=(abs(rotate.scale), abs(down_up.scale), abs(out_in.scale), abs(pitch.scale)),
        lease_samples=lease_samples,
        lease_ns=description.permit_ttl_ns,
        faults_per_s=FAULTS_PER_S,
        missed_samples=missed_limit(lease_samples),
    )


def observer_params(config: SupervisorConfig, description: PlantDescription, tare_ticks: int) -> ObserverParams:
    """What the windows are computed with."""
    machine = description.machine
    return ObserverParams(
        calibration=calibration(machine.encoders, machine.force),
        geometry=machine.geometry,
        gauge=machine.gauge,
        tip_count_m=machine.motion.tip_count_m,
        codes=_codes(machine),
        tare_ticks=tare_ticks,
        period_ns=description.sample_period_ns,
        force_axis=description.force_axis,
        force_sign=description.force_sign,
        quiet_counts=machine.gauge.quiet_counts if _quiet_samples(description) >= FEWEST_QUIET else 0,
        contact_level_n=config.contact_level_n,
    )


def _codes(machine: MachineDescription) -> DriveCodes:
    """D/A codes that must move a link, and where its stops are."""
    rotate, down_up, out_in = machine.converters
    down_a, up_a = machine.motion.moves_down_a, machine.motion.moves_up_a
    return DriveCodes(
        low=(
            math.floor((-down_a[0] - rotate.offset) / rotate.scale),
            math.floor((-down_a[1] - down_up.offset) / down_up.scale),
            math.floor((-down_a[2] - out_in.offset) / out_in.scale),
        ),
        high=(
            math.ceil((up_a[0] - rotate.offset) / rotate.scale),
            math.ceil((up_a[1] - down_up.offset) / down_up.scale),
            math.ceil((up_a[2] - out_in.offset) / out_in.scale),
        ),
        count_q=(abs(machine.encoders[0].scale), abs(machine.encoders[1].scale), abs(machine.encoders[2].scale)),
        travel_low=machine.geometry.low_q,
        travel_high=machine.geometry.high_q,
    )


def _quiet_samples(description: PlantDescription) -> int:
    """Samples in 100 ms; where they are few, only a reading that repeats itself counts as quiet (8 % of its neighbours)."""
    return QUIET_NS // description.sample_period_ns


def below_gate(config: SupervisorConfig, description: PlantDescription) -> bool:
    """Whether the supervisor's limit, bias and noise together stay below the gate's own limit."""
    return config.force_limit_n + config.bias_limit_n + description.machine.gauge.noise_n < description.gate_force_limit_n
