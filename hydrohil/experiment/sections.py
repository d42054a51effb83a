"""The sections of an experiment as the services define them: types, defaults, and what follows from a section alone.

Packages above take them from here, so that only this package knows in which service's file a section stands.
"""

from hydrohil.services.controller.config import (
    ActingLinks,
    AdaptationConfig,
    ControllerConfig,
    ImpedanceConfig,
    Reference,
    ScheduledChange,
    Segment,
)
from hydrohil.services.controller.parameter_schedule import scheduled
from hydrohil.services.controller.params import DOWN_UP_GAINS, UNIMATE_GAINS, Gains, LinkGains
from hydrohil.services.plant.config import GateLimits, PlantConfig, StartPosition, latch_substeps, tare_ticks
from hydrohil.services.plant.params import UNIMATE_PARAMS, Environment, LinkParams, MachineParams
from hydrohil.services.supervisor.config import SupervisorConfig

__all__ = [
    "DOWN_UP_GAINS",
    "UNIMATE_GAINS",
    "UNIMATE_PARAMS",
    "ActingLinks",
    "AdaptationConfig",
    "ControllerConfig",
    "Environment",
    "Gains",
    "GateLimits",
    "ImpedanceConfig",
    "LinkGains",
    "LinkParams",
    "MachineParams",
    "PlantConfig",
    "Reference",
    "ScheduledChange",
    "Segment",
    "StartPosition",
    "SupervisorConfig",
    "latch_substeps",
    "scheduled",
    "tare_ticks",
]
