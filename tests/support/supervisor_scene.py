"""A supervisor with an experiment of 100 ticks after 8 of bias, and a plant that answers it."""

from hydrohil.services.plant.config import GateLimits, PlantConfig
from hydrohil.services.plant.plant_description import describe
from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.services.supervisor.modes import NOTHING, RUNNING
from hydrohil.services.supervisor.observe import Bias, Heard, Links, observe_step, watch_start
from hydrohil.services.supervisor.params import supervisor_params
from hydrohil.services.supervisor.rule import GaugeObservation, MotionObservation, Observed, TransportObservation
from hydrohil.services.supervisor.step import Asked, SupervisorMemory, supervisor_step
from hydrohil.shared.contract.messages import NO_TRIAL, Sample

BIAS, DURATION = 8, 100
CONFIG = SupervisorConfig()
DESCRIPTION = describe(PlantConfig(), GateLimits())
PARAMS = supervisor_params(CONFIG, DESCRIPTION, BIAS, DURATION)
LIMITS = PARAMS.limits
N_PER_COUNT = PARAMS.observing.calibration.force_n_per_count
LEVEL = (4031, 971, 207, 0, 33)  # all links level, boom out by 0.21 m

FINE = Observed(
    True,
    True,
    5,
    GaugeObservation(
        force_counts=10,
        raw_n=13.5,
        tared_n=1.0,
        bias_n=12.5,
        bias_spread_n=4.0,
        smooth_n=0.5,
        rate_n_per_s=40.0,
        jump_n=2.7,
        jump_limit_n=56.0,
        unexplained_n=3.0,
        unexplained_limit_n=107.0,
        quiet_samples=1,
        held_ns=0,
        energy_j=0.0,
    ),
    MotionObservation(
        q=(0.0, 0.0, 0.2),
        tip_m=(0.6, 0.0, 0.1),
        counts=(4031, 971, 207),
        moved_q=(0.0, 0.0, 0.0, 0.0),
        dt_s=0.0045,
        speed=(0.0, 0.0, 0.0),
        tip_speed_m_per_s=0.0,
        idle_ns=(0, 0, 0),
        against=(0.0, 0.0, 0.0),
    ),
    TransportObservation(
        lost_samples=0,
        stale_ns=0,
        command_lag=1,
        gate=1,
        ready=True,
        link_faults=0,
        epoch_conflicts=0,
        other_run=0,
        state_lag=1,
        missed=0,
    ),
)


def changed(seen, **changes):
    """`seen` with other fields, whichever part they are in."""
    for part in ("gauge", "motion", "transport"):
        own = {field: changes.pop(field) for field in getattr(seen, part)._fields if field in changes}
        seen = seen._replace(**{part: getattr(seen, part)._replace(**own)})
    return seen._replace(**changes)


def sample(number, tick=NO_TRIAL, **changes):
    made = Sample(
        number, number * 4_500_000, tick, 0, LEVEL, 4 + 3 * (number % 2), (2048, 2048, 2048), 0, 1, 0, (0, 0, 0), number - 1, 0, 0
    )
    return made._replace(**changes)


def asked(event=NOTHING, **changes):
    return Asked(int(event), 4711, True, True, 0, Links(0, 0, 0, 1))._replace(**changes)


def step(memory, seen, wanted=None, params=PARAMS):
    return supervisor_step(memory, params, seen, wanted or asked())[0]


def watched(number, encoder_counts=LEVEL, **changes):
    """What is remembered after sample `number`, the first that came."""
    seen = sample(number, encoder_counts=encoder_counts)
    return observe_step(watch_start(), PARAMS.observing, seen, Heard(False, 0, True, Links(0, 0, 0, 1)))[0]._replace(**changes)


def running(tick=5, number=50, **changes):
    """In the middle of a trial whose first sample was such that `number` is `tick`."""
    first = number - tick - BIAS
    watch = watched(number - 1, bias=Bias(0.0, 0.0, 0.0, 0.0, BIAS))
    return SupervisorMemory(mode=RUNNING, arming_id=4711, first_sample=first, watch=watch)._replace(**changes)
