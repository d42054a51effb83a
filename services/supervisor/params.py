"""The supervisor's parameters for one trial, from its section, the plant's description and the trial's length."""

import math

from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.services.supervisor.machine import (
    FEWEST_QUIET,
    GAUGE_RANGE_N,
    MOVES_DOWN_A,
    MOVES_UP_A,
    NOISE_N,
    QUIET_COUNTS,
    QUIET_NS,
)
from hydrohil.services.supervisor.observe import ObserverParams
from hydrohil.services.supervisor.observe_motion import DriveCodes
from hydrohil.services.supervisor.rule import Limits
from hydrohil.services.supervisor.state import SupervisorParams
from hydrohil.shared.contract.converters import N_PER_FORCE_COUNT, calibration
from hydrohil.shared.contract.deadline_window import missed_limit
from hydrohil.shared.contract.messages import PlantDescription
from hydrohil.shared.transport.protection import FAULTS_PER_S
from hydrohil.shared.units import NS_PER_S

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
    rotate, down_up, out_in, _, pitch = description.encoders
    lease_samples = description.permit_ttl_ns // description.sample_period_ns
    return Limits(
        config,
        0,
        int(GAUGE_RANGE_N / N_PER_FORCE_COUNT),
        _quiet_samples(description),
        (rotate.low, down_up.low, out_in.low),
        (rotate.high, down_up.high, out_in.high),
        (abs(rotate.scale), abs(down_up.scale), abs(out_in.scale), abs(pitch.scale)),
        lease_samples,
        description.permit_ttl_ns,
        FAULTS_PER_S,
        missed_limit(lease_samples),
    )


def observer_params(config: SupervisorConfig, description: PlantDescription, tare_ticks: int) -> ObserverParams:
    """What the windows are computed with."""
    rotate, down_up, out_in = description.converters
    codes = DriveCodes(
        (
            math.floor((-MOVES_DOWN_A[0] - rotate.offset) / rotate.scale),
            math.floor((-MOVES_DOWN_A[1] - down_up.offset) / down_up.scale),
            math.floor((-MOVES_DOWN_A[2] - out_in.offset) / out_in.scale),
        ),
        (
            math.ceil((MOVES_UP_A[0] - rotate.offset) / rotate.scale),
            math.ceil((MOVES_UP_A[1] - down_up.offset) / down_up.scale),
            math.ceil((MOVES_UP_A[2] - out_in.offset) / out_in.scale),
        ),
        (abs(description.encoders[0].scale), abs(description.encoders[1].scale), abs(description.encoders[2].scale)),
    )
    return ObserverParams(
        calibration(description.encoders, description.force),
        codes,
        tare_ticks,
        description.sample_period_ns,
        description.force_axis,
        description.force_sign,
        QUIET_COUNTS if _quiet_samples(description) >= FEWEST_QUIET else 0,
        config.contact_level_n,
    )


def _quiet_samples(description: PlantDescription) -> int:
    """Samples in 100 ms; where they are few, only a reading that repeats itself counts as quiet (8 % of its neighbours)."""
    return QUIET_NS // description.sample_period_ns


def below_gate(config: SupervisorConfig, description: PlantDescription) -> bool:
    """Whether the supervisor's limit, bias and noise together stay below the gate's own limit."""
    return config.force_limit_n + config.bias_limit_n + NOISE_N < description.gate_force_limit_n
