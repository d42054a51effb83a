"""The supervisor's parameters for one trial, from its section, the plant's description and the trial's length."""

from services.supervisor.config import SupervisorConfig
from services.supervisor.observe import Observing
from services.supervisor.rule import Limits
from services.supervisor.step import SupervisorParams
from shared.converters import N_PER_FORCE_COUNT, calibration
from shared.messages import About
from shared.protection import FAULTS_PER_S
from shared.units import NS_PER_S

GAUGE_RANGE_N = 700.0
NOISE_N = 10.0  # "+-10 N of noise" (thesis 5.1.2)
RANDOM_MISSES = 16  # of 100: a link that loses 1 % each way has more in 7e-9 of all windows, one that loses 20 % in nearly all
_LEAD_S, _ARMED_S, _RECOVER_S = 0.25, 60.0, 0.3


def supervisor_params(config: SupervisorConfig, about: About, bias_ticks: int, duration_ticks: int) -> SupervisorParams:
    """Everything the supervisor's step needs."""
    lease_samples = about.permit_ttl_ns // about.sample_period_ns

    missed = lease_samples + 1 + RANDOM_MISSES  # one outage as long as the lease bears, and the misses of a lossy link

    def samples(seconds: float) -> int:
        return int(seconds * NS_PER_S) // about.sample_period_ns

    return SupervisorParams(
        Limits(config, 0, int(GAUGE_RANGE_N / N_PER_FORCE_COUNT), lease_samples, about.permit_ttl_ns, FAULTS_PER_S, missed),
        Observing(calibration(about.encoders, about.force), bias_ticks),
        about.force_axis,
        about.force_sign,
        duration_ticks,
        samples(_LEAD_S),
        samples(_ARMED_S),
        samples(_RECOVER_S),
    )


def below_gate(config: SupervisorConfig, about: About) -> bool:
    """Whether the supervisor's limit, bias and noise together stay below the gate's own limit."""
    return config.force_limit_n + config.bias_limit_n + NOISE_N < about.gate_force_limit_n
