"""A supervisor with an experiment of 100 ticks after 8 of bias, and a plant that answers it."""

from hydrohil.services.plant.config import GateLimits, PlantConfig
from hydrohil.services.plant.plant_description import describe
from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.services.supervisor.modes import NOTHING, RUNNING
from hydrohil.services.supervisor.observe import Bias, LinkHealth, SampleContext, observe_step, observer_start
from hydrohil.services.supervisor.params import supervisor_params
from hydrohil.services.supervisor.rule import GaugeObservation, MotionObservation, Observed, TransportObservation
from hydrohil.services.supervisor.state import SupervisorInput, SupervisorMemory
from hydrohil.services.supervisor.step import supervisor_step
from hydrohil.shared.contract.messages import NO_TRIAL, Sample

BIAS, DURATION = 8, 100
CONFIG = SupervisorConfig()
DESCRIPTION = describe(PlantConfig(), GateLimits())
PARAMS = supervisor_params(CONFIG, DESCRIPTION, BIAS, DURATION)
LIMITS = PARAMS.limits
N_PER_COUNT = PARAMS.observer.calibration.force_n_per_count
SOUND_LINKS = LinkHealth(faults=0, epoch_conflicts=0, other_run=0, state_lag=1)
LEVEL = (4031, 971, 207, 0, 33)  # all links level, boom out by 0.21 m

FINE = Observed(
    moving=True,
    starting=True,
    tick=5,
    gauge=GaugeObservation(
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
    motion=MotionObservation(
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
    transport=TransportObservation(
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


def changed(observed, **changes):
    """`observed` with other fields, whichever part they are in."""
    for part in ("gauge", "motion", "transport"):
        own = {field: changes.pop(field) for field in getattr(observed, part)._fields if field in changes}
        observed = observed._replace(**{part: getattr(observed, part)._replace(**own)})
    return observed._replace(**changes)


def sample(number, tick=NO_TRIAL, **changes):
    quiet = Sample(
        number=number,
        time_ns=number * 4_500_000,
        tick=tick,
        trial_time_ns=0,
        encoder_counts=LEVEL,
        force_counts=4 + 3 * (number % 2),
        dac_counts=(2048, 2048, 2048),
        gate=0,
        gate_cause=1,
        gate_open_samples=0,
        recover_signs=(0, 0, 0),
        command_number=number - 1,
        command_late_substeps=0,
        command_age_ns=0,
    )
    return quiet._replace(**changes)


def asked(event=NOTHING, **changes):
    quiet = SupervisorInput(
        event=int(event),
        new_arming_id=4711,
        agreed=True,
        controller_ready=True,
        stale_ns=0,
        links=SOUND_LINKS,
    )
    return quiet._replace(**changes)


def step(memory, current, inputs=None, params=PARAMS):
    return supervisor_step(memory, params, current, inputs or asked())[0]


def watched(number, encoder_counts=LEVEL, **changes):
    """What is remembered after sample `number`, the first that came."""
    context = SampleContext(running=False, stale_ns=0, ready=True, links=SOUND_LINKS)
    memory, _ = observe_step(observer_start(), PARAMS.observer, sample(number, encoder_counts=encoder_counts), context)
    return memory._replace(**changes)


def running(tick=5, number=50, **changes):
    """In the middle of a trial whose first sample was such that `number` is `tick`."""
    first = number - tick - BIAS
    observer = watched(number - 1, bias=Bias(0.0, 0.0, 0.0, 0.0, BIAS))
    return SupervisorMemory(mode=RUNNING, arming_id=4711, first_sample=first, observer=observer)._replace(**changes)
