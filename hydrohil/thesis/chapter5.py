"""Chapter 5 of the thesis: position based impedance control in free space, on the plate and against the crate.

What the text leaves open is chosen once here: the force step of 100 N in every test, the sine from 50 to 250 N (the
text speaks of forces above 200 N), the circle of 0.06 m in 16 s, the push at 0.04 m/s. On the plate a trial begins in
light contact, which the bias removal then takes for zero.
"""

import math

from hydrohil.claims.pairs import PairClaim
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import (
    UNIMATE_PARAMS,
    ActingLinks,
    ControllerConfig,
    Environment,
    ImpedanceConfig,
    PlantConfig,
    Segment,
    StartPosition,
)
from hydrohil.thesis import claims5

JITTER_SUBSTEPS = 10  # 4.5 ms on average, "in (4, 5]": the program waited a whole number of milliseconds
Q3_M = 0.212  # the tip is 1 m out, the lever at which the gains were tuned
START = StartPosition(out_in=Q3_M)
DOWN_UP_ALONE = ActingLinks(rotate=False, out_in=False)
TIP_X_M = Q3_M + UNIMATE_PARAMS.d3_offset_m  # of that pose, with the tool straight down
TIP_Z_M = UNIMATE_PARAMS.a2_m - UNIMATE_PARAMS.a4_m
PRELOAD_N = 12.0  # light contact: more than the gauge's noise, far below the 60 N that a bias may be

SOFT_N_PER_M, STIFF_N_PER_M = 7208.0, 53150.0  # plate, 48 E I / L^3 (5.1.1: 7.2 and 53 kN/m)
SOFT_ESTIMATE_N_PER_M, STIFF_ESTIMATE_N_PER_M = 6200.0, 25e3  # with the gauge, as the controller assumes (5.3)
FORCE_STEP_N = 100.0
STEP_S = 0.5  # instant of a force step


def sampled(environment: Environment) -> PlantConfig:
    """The machine in its start pose, sampled as in the thesis."""
    return PlantConfig(environment=environment, initial_q=START, jitter_substeps=JITTER_SUBSTEPS)


def plate(stiffness_n_per_m: float, preload_n: float, below_m: float = 0.0) -> PlantConfig:
    """A plate that presses on the tool with `preload_n` at the start, or lies `below_m` under it."""
    gauge = UNIMATE_PARAMS.sensor_stiffness_n_per_m
    in_series = stiffness_n_per_m * gauge / (stiffness_n_per_m + gauge)
    surface_m = TIP_Z_M + preload_n / in_series - below_m
    return sampled(Environment(kind="plate", stiffness_n_per_m=stiffness_n_per_m, surface_m=surface_m))


def free_space(figure: str, damping: str, damping_ratio: float, duration_s: float) -> Experiment:
    """A force step far from any obstacle: m = 125 kg, k = 500 N/m."""
    name = f"fig-{figure}"
    return Experiment(
        name=name,
        alias=f"free-space-{damping}",
        title=f"Free space response to 100 N, {damping}",
        source=f"thesis figure {figure}, section 5.2",
        duration_s=duration_s,
        plant=sampled(Environment()),
        controller=ControllerConfig(
            impedance=ImpedanceConfig(
                mass_kg=125.0,
                stiffness_n_per_m=500.0,
                damping_ratio=damping_ratio,
                damping="model",
                environment_n_per_m=SOFT_ESTIMATE_N_PER_M,
            )
        ),
        reference=(Segment("force", "step", STEP_S, amount=FORCE_STEP_N),),
        claims=claims5.CLAIMS[name],
    )


def force_control(
    figure: str, alias: str, title: str, soft: bool, reference: tuple[Segment, ...], duration_s: float
) -> Experiment:
    """Force on the plate with set-point compensation: m = 500 kg, xi_net = 1.2, k = 50 kN/m (5.3, 5.4)."""
    name, section = f"fig-{figure}", "5.3" if figure in ("5-5", "5-6") else "5.4"
    estimate_n_per_m = SOFT_ESTIMATE_N_PER_M if soft else STIFF_ESTIMATE_N_PER_M
    return Experiment(
        name=name,
        alias=alias,
        title=title,
        source=f"thesis figure {figure}, section {section}",
        duration_s=duration_s,
        plant=plate(SOFT_N_PER_M if soft else STIFF_N_PER_M, PRELOAD_N),
        controller=ControllerConfig(
            impedance=ImpedanceConfig(
                mass_kg=500.0,
                stiffness_n_per_m=50e3,
                damping_ratio=1.2,
                damping="net",
                environment_n_per_m=estimate_n_per_m,
                setpoint_compensation=True,
            )
        ),
        reference=reference,
        claims=claims5.CLAIMS[name],
    )


STATIC_S, DYNAMIC_S = 20.0, 20.0
STATIC = (Segment("force", "step", STEP_S, amount=FORCE_STEP_N),)
DYNAMIC = (  # 150 N -+ 100 N, from its lowest point: between 5 and 10 s the force falls, the tool rises
    Segment("force", "step", amount=50.0),
    Segment("force", kind="sine", start_s=0.0, duration_s=DYNAMIC_S, amount=100.0, frequency_hz=0.1, phase_rad=-math.pi / 2.0),
)

RADIUS_M, TURN_S, TURNS = 0.06, 16.0, 2
CIRCLE = (  # in the x-z plane, from its top, forwards and down; the plate cuts it in half
    Segment("x", kind="sine", start_s=0.0, duration_s=TURNS * TURN_S, amount=RADIUS_M, frequency_hz=1.0 / TURN_S),
    Segment(
        "z",
        kind="sine",
        start_s=0.0,
        duration_s=TURNS * TURN_S,
        amount=RADIUS_M,
        frequency_hz=1.0 / TURN_S,
        phase_rad=math.pi / 2.0,
    ),
)


def circle(figures: str, soft: bool) -> Experiment:
    """A circle cut in half by the plate: m = 50 kg, xi_net = 1.0, k = 1 kN/m (5.5)."""
    name, words = f"fig-{figures.split(' ', maxsplit=1)[0]}", "soft" if soft else "stiff"
    estimate_n_per_m = SOFT_ESTIMATE_N_PER_M if soft else STIFF_ESTIMATE_N_PER_M
    return Experiment(
        name=name,
        alias=f"circle-{words}-plate",
        title=f"Circle interrupted by the {words} plate",
        source=f"thesis figures {figures}, section 5.5",
        duration_s=TURNS * TURN_S,
        plant=plate(SOFT_N_PER_M if soft else STIFF_N_PER_M, 0.0, RADIUS_M),
        controller=ControllerConfig(
            impedance=ImpedanceConfig(
                mass_kg=50.0, stiffness_n_per_m=1e3, damping_ratio=1.0, damping="net", environment_n_per_m=estimate_n_per_m
            )
        ),
        reference=CIRCLE,
        claims=claims5.CLAIMS[name],
    )


GAP_M = 0.05  # between the tool and the crate
PUSH_M, PUSH_M_PER_S, PUSH_BLEND_S = 0.32, 0.04, 0.2
PUSH = (
    Segment(
        "x", kind="ramp", start_s=STEP_S, duration_s=PUSH_M / PUSH_M_PER_S + PUSH_BLEND_S, amount=PUSH_M, blend_s=PUSH_BLEND_S
    ),
)


def push(figure: str, alias: str, title: str, controller: ControllerConfig) -> Experiment:
    """A straight push against the crate of 64 kg (5.6)."""
    name = f"fig-{figure}"
    return Experiment(
        name=name,
        alias=alias,
        title=title,
        source=f"thesis figure {figure}, section 5.6",
        duration_s=10.0,
        plant=sampled(Environment(kind="crate", surface_m=TIP_X_M + GAP_M)),
        controller=controller,
        reference=PUSH,
        claims=claims5.CLAIMS[name],
    )


EXPERIMENTS = (
    free_space("5-2", "underdamped", 0.3, 15.0),
    free_space("5-3", "critically-damped", 1.0, 10.0),
    free_space("5-4", "overdamped", 3.0, 25.0),
    force_control(
        "5-5",
        alias="static-force-soft-plate",
        title="Static force control, soft plate",
        soft=True,
        reference=STATIC,
        duration_s=STATIC_S,
    ),
    force_control(
        "5-6",
        alias="static-force-stiff-plate",
        title="Static force control, stiff plate",
        soft=False,
        reference=STATIC,
        duration_s=STATIC_S,
    ),
    force_control(
        "5-7",
        alias="dynamic-force-soft-plate",
        title="Dynamic force control, soft plate",
        soft=True,
        reference=DYNAMIC,
        duration_s=DYNAMIC_S,
    ),
    force_control(
        "5-8",
        alias="dynamic-force-stiff-plate",
        title="Dynamic force control, stiff plate",
        soft=False,
        reference=DYNAMIC,
        duration_s=DYNAMIC_S,
    ),
    circle("5-9 and 5-10", True),
    circle("5-11 and 5-12", False),
    push(
        "5-13",
        "push-crate-impedance",
        "Push against a crate, impedance control",
        ControllerConfig(
            impedance=ImpedanceConfig(
                mass_kg=500.0,
                stiffness_n_per_m=5e3,
                damping_ratio=1.0,
                damping="model",
                environment_n_per_m=STIFF_ESTIMATE_N_PER_M,
            )
        ),
    ),
    push("5-14", "push-crate-position", "Push against a crate, position control", ControllerConfig(target="cartesian")),
)
PAIRS: tuple[PairClaim, ...] = ()
