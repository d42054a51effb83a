"""A supervisor with an experiment of 100 ticks after 8 of bias, and a plant that answers it."""

from services.plant.about import about
from services.plant.config import GateLimits, PlantConfig
from services.supervisor.config import SupervisorConfig
from services.supervisor.modes import NOTHING, RUNNING
from services.supervisor.params import supervisor_params
from services.supervisor.rules import Observed
from services.supervisor.step import Asked, SupervisorMemory, supervisor_step
from shared.messages import NO_TRIAL, Sample

BIAS, DURATION = 8, 100
CONFIG = SupervisorConfig()
ABOUT = about(PlantConfig(), GateLimits())
PARAMS = supervisor_params(CONFIG, ABOUT, BIAS, DURATION)
LIMITS = PARAMS.limits
N_PER_COUNT = PARAMS.calibration.force_n_per_count
LEVEL = (4031, 971, 207, 0, 33)  # all links level, boom out by 0.21 m

FINE = Observed(True, True, 10, 13.5, 1.0, 12.5, 4.0, (0.0, 0.0, 0.2), (0.6, 0.0, 0.1), 0, 0, 1, 1, 5, True)


def sample(number, tick=NO_TRIAL, **changes):
    made = Sample(number, number * 4_500_000, tick, 0, LEVEL, 4, (2048, 2048, 2048), 0, 1, 0, (0, 0, 0), number - 1, 0, 0)
    return made._replace(**changes)


def asked(event=NOTHING, **changes):
    return Asked(int(event), 4711, True, True, 0)._replace(**changes)


def step(memory, seen, wanted=None, params=PARAMS):
    return supervisor_step(memory, params, seen, wanted or asked())[0]


def running(tick=5, number=50, **changes):
    """In the middle of a trial whose first sample was such that `number` is `tick`."""
    first = number - tick - BIAS
    return SupervisorMemory(mode=RUNNING, arming=4711, first_sample=first, last_number=number - 1, bias_count=BIAS)._replace(
        **changes
    )
