"""The two motions of the fault test: a swing in free space, and a force that rises and falls on the stiff plate."""

import math

from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import ControllerConfig, Environment, ImpedanceConfig, Segment
from hydrohil.thesis.chapter5 import PRELOAD_N, STIFF_ESTIMATE_N_PER_M, STIFF_N_PER_M, plate, sampled

LONG_S = 60.0  # no trial of the fault test reaches its end
BIAS_S = 0.5  # short, so that many trials fit into a quarter of an hour
SWING = Experiment(
    name="faults-swing",
    alias="faults-swing",
    title="The up/down link swings in free space, its valve never at rest for long",
    source="the fault test",
    duration_s=LONG_S,
    plant=sampled(Environment())._replace(bias_s=BIAS_S),
    controller=ControllerConfig(target="joint"),
    reference=(Segment(channel="q2", kind="sine", start_s=0.0, duration_s=LONG_S, amount=0.1, frequency_hz=0.5),),
)
PRESS = Experiment(
    name="faults-press",
    alias="faults-press",
    title="A force from 50 to 250 N on the stiff plate, as in chapter 5 but five times as fast",
    source="the fault test",
    duration_s=LONG_S,
    plant=plate(STIFF_N_PER_M, PRELOAD_N)._replace(bias_s=BIAS_S),
    controller=ControllerConfig(
        impedance=ImpedanceConfig(
            mass_kg=500.0,
            stiffness_n_per_m=50e3,
            damping_ratio=1.2,
            damping="net",
            environment_n_per_m=STIFF_ESTIMATE_N_PER_M,
            setpoint_compensation=True,
        )
    ),
    reference=(
        Segment("force", "step", amount=50.0),
        Segment(
            channel="force", kind="sine", start_s=0.0, duration_s=LONG_S, amount=100.0, frequency_hz=0.5, phase_rad=-math.pi / 2.0
        ),
    ),
)


def motion(number: int) -> Experiment:
    """Free space and contact in turn."""
    return PRESS if number % 2 else SWING
