"""Appendix E of the thesis: the force gauge pressed against a stiff object, level by level.

The text gives neither object nor levels. Chosen once here: an object of 500 kN/m, eleven times the gauge, and 50 to 250 N.
"""

from hydrohil.claims.bands import Measure, at_least
from hydrohil.claims.pairs import PairClaim
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import UNIMATE_PARAMS, ControllerConfig, Environment, ImpedanceConfig, Segment
from hydrohil.thesis.chapter5 import TIP_Z_M, sampled

CHAIR_N_PER_M = 500e3
LEVELS_N = (50.0, 100.0, 150.0, 200.0, 250.0)
LEVEL_S = 6.0
PRELOAD_N = 12.0  # light contact, which the bias removal takes for zero
GAUGE_N_PER_M = UNIMATE_PARAMS.sensor_stiffness_n_per_m
IN_SERIES_N_PER_M = CHAIR_N_PER_M * GAUGE_N_PER_M / (CHAIR_N_PER_M + GAUGE_N_PER_M)

_PRESSED = (
    'thesis Appendix E: "The manipulator was positioned so that it was exerting a downwards force on a stiff object, such as a '
    'chair."'
)
STAIRCASE = tuple(Segment("force", "step", number * LEVEL_S, amount=LEVELS_N[0]) for number in range(len(LEVELS_N)))
DURATION_S = len(LEVELS_N) * LEVEL_S

EXPERIMENTS = (
    Experiment(
        name="gauge-staircase",
        alias="sensor-stiffness",
        title="Force on a stiff object, level by level",
        source="thesis figure 9-2, Appendix E",
        duration_s=DURATION_S,
        plant=sampled(
            Environment(kind="plate", stiffness_n_per_m=CHAIR_N_PER_M, surface_m=TIP_Z_M + PRELOAD_N / IN_SERIES_N_PER_M)
        ),
        controller=ControllerConfig(
            impedance=ImpedanceConfig(
                mass_kg=500.0,
                stiffness_n_per_m=50e3,
                damping_ratio=1.2,
                damping="net",
                environment_n_per_m=IN_SERIES_N_PER_M,
                setpoint_compensation=True,
            )
        ),
        reference=STAIRCASE,
        claims=(at_least("The tool never leaves the object", Measure("minimum", "force", "N", 1.0, DURATION_S), 10.0, _PRESSED),),
    ),
)
PAIRS: tuple[PairClaim, ...] = ()
