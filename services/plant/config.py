"""What an experiment may say to the plant, and what only the plant's start-up may say."""

from typing import Annotated, NamedTuple

from annotated_types import Ge, Gt, Interval

from hydrohil.services.plant.params import UNIMATE_PARAMS, Environment, MachineParams
from hydrohil.shared.machine import unimate
from hydrohil.shared.transport.protection import FAULTS_PER_S
from hydrohil.shared.units import NS_PER_S, SUBSTEP_NS

DESCRIPTION = unimate.UNIMATE
TRAVEL = DESCRIPTION.geometry

_LATCH_LIMIT_SUBSTEPS = 80  # 4 ms: the thesis' program wrote its outputs about 4 ms after reading the encoders


class StartPosition(NamedTuple):
    """Where the links stand at the start, rad, rad and m."""

    rotate: Annotated[float, Interval(ge=TRAVEL.low_q[0], le=TRAVEL.high_q[0])] = 0.0
    down_up: Annotated[float, Interval(ge=TRAVEL.low_q[1], le=TRAVEL.high_q[1])] = 0.0
    out_in: Annotated[float, Interval(ge=TRAVEL.low_q[2], le=TRAVEL.high_q[2])] = 0.212


class PlantConfig(NamedTuple):
    """Section [plant] of an experiment: the emulated machine, what it touches, where it starts, how it is sampled."""

    machine_name: str = DESCRIPTION.name  # whose channels, bounds and limits hold
    machine: MachineParams = UNIMATE_PARAMS
    environment: Environment = Environment()
    initial_q: StartPosition = StartPosition()
    sample_period_substeps: Annotated[int, Interval(ge=20, le=200)] = 90  # 1 kHz to 100 Hz; 4.5 ms in the thesis
    jitter_substeps: Annotated[int, Interval(ge=0, le=20)] = 0  # each interval is uniform within +- this
    latch_substeps: Annotated[int, Ge(0)] = 0  # 0 = min(4 ms, 0.8 of the period)
    bias_s: Annotated[float, Interval(gt=0.1, le=10.0)] = 2.0  # force bias removal (5.1.2)


class GateLimits(NamedTuple):
    """Limits of the gate. They come from the plant's start-up alone: no message changes them."""

    permit_ttl_ns: Annotated[int, Gt(0)] = 20_000_000  # lease of industrial arms
    command_ttl_ns: Annotated[int, Gt(0)] = 20_000_000
    force_limit_n: Annotated[float, Gt(0)] = 420.0  # raw; above supervisor limit 334 + bias 60 + noise 10 N
    min_code: int = DESCRIPTION.converters[0].low
    max_code: int = DESCRIPTION.converters[0].high
    slew_codes: Annotated[int, Gt(0)] = 2456  # full range: the laws of the thesis command full swing in one sample
    tight_slew_codes: Annotated[int, Gt(0)] = 100  # 29 mA, inside the valve's overlap of 36 mA
    tight_samples: Annotated[int, Ge(0)] = 20  # after the gate opens
    recover_codes: Annotated[int, Gt(0)] = 700  # 205 mA: above the worst break-away (176 mA, link 3 in)
    min_force_counts: int = 0  # the gauge reads one direction
    max_force_counts: int = int(DESCRIPTION.gauge.range_n / DESCRIPTION.force.scale)  # 518: saturated beyond
    faults_per_s: Annotated[int, Ge(0)] = FAULTS_PER_S


def latch_substeps(config: PlantConfig) -> int:
    """Sub-steps from a sample to the instant at which the D/A takes the command in.

    Raises ValueError if the jitter leaves no room for it.
    """
    shortest = config.sample_period_substeps - config.jitter_substeps
    default = min(_LATCH_LIMIT_SUBSTEPS, config.sample_period_substeps * 4 // 5, shortest)
    latch = config.latch_substeps or default
    if latch > shortest:
        raise ValueError(
            f"plant.latch_substeps is {latch} sub-steps, beyond the shortest interval of {shortest}: "
            "choose a smaller latch or less jitter"
        )
    return latch


def tare_ticks(config: PlantConfig) -> int:
    """Samples of force bias removal before tick 0."""
    return int(config.bias_s * NS_PER_S) // (config.sample_period_substeps * SUBSTEP_NS)


def trial_ticks(config: PlantConfig, duration_s: float) -> tuple[int, int]:
    """First tick of a trial, and the one after its last."""
    return -tare_ticks(config), round(duration_s * NS_PER_S / (config.sample_period_substeps * SUBSTEP_NS))
