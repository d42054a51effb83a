"""Times and thresholds that the services decide by, for trials that are laid out or judged by the same numbers."""

from hydrohil.services.controller.limit_cycle import LEAST, MOST, least_stable_n_per_m
from hydrohil.services.controller.parameter_change import RAMP_S
from hydrohil.services.supervisor.observe_motion import SMOOTHING_S

__all__ = [
    "LEAST",
    "MOST",
    "RAMP_S",
    "SMOOTHING_S",
    "least_stable_n_per_m",
]
