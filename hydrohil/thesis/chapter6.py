"""Chapter 6 of the thesis: impedance control beside its equivalent explicit force controller; and what it leaves open.

Only the up/down link acts, at a lever of 1 m, under the linear PI law. The force steps at 2 s (Appendix F, `set_qd`). The text
gives no durations, but says that they were too short for the control to reach full strength at a low stiffness: 12 s leave
the step six time constants of the slowest closed loop (1.6 s), far from that of the filter at k = 50 N/m (212 s). As in
chapter 5 a trial begins in light contact, which the bias removal takes for zero.

The alternate formulation (6.2.2 b) answers the question of 9.3.3, whether the constraint on the target stiffness applies to it
too, with the trials of chapter 7 under the final law and all links, and with one that touches nothing. With the targets of
chapter 7 it trips the force limit within 5 s: the measured velocity comes through the position loop, which must be quicker
than c/m, 35 rad/s there. The mass is therefore ten times as large and xi_net 1, which keeps c/m below 7 rad/s.
"""

from typing import Literal

from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import ControllerConfig, Environment, ImpedanceConfig, Segment
from hydrohil.thesis import claims6, claims7
from hydrohil.thesis.chapter5 import DOWN_UP_ALONE, PRELOAD_N, SOFT_ESTIMATE_N_PER_M, SOFT_N_PER_M, plate, sampled

REFERENCE = (Segment("force", "step", claims6.STEP_S, amount=claims6.STEP_N),)
MASS_KG, NET_DAMPING = 500.0, 3.0
ALTERNATE_MASS_KG, ALTERNATE_NET_DAMPING = 5000.0, 1.0


def equivalence(figure: str, target: Literal["impedance", "explicit"], stiffness_n_per_m: float) -> Experiment:
    """A force step on the soft plate: m = 500 kg, xi_net = 3 (6.3)."""
    name, words = f"fig-{figure}", {"impedance": "Impedance controller", "explicit": "Equivalent explicit force controller"}
    return Experiment(
        name=name,
        alias=f"{target}-step-k{stiffness_n_per_m:.0f}",
        title=f"{words[target]}, k = {stiffness_n_per_m:g} N/m",
        source=f"thesis figure {figure}, section 6.3",
        duration_s=claims6.END_S,
        plant=plate(SOFT_N_PER_M, PRELOAD_N),
        controller=ControllerConfig(
            law="pi",
            target=target,
            acting=DOWN_UP_ALONE,
            impedance=ImpedanceConfig(
                mass_kg=MASS_KG,
                stiffness_n_per_m=stiffness_n_per_m,
                damping_ratio=NET_DAMPING,
                damping="net",
                environment_n_per_m=SOFT_ESTIMATE_N_PER_M,
            ),
        ),
        reference=REFERENCE,
        claims=claims6.CLAIMS[name],
    )


def prolonged(formulation: Literal["setpoint", "measured"], name: str, alias: str, stiffness_n_per_m: float) -> Experiment:
    """Prolonged force control on the soft plate by either formulation: m = 5000 kg, xi_net = 1."""
    impedance = ImpedanceConfig(
        mass_kg=ALTERNATE_MASS_KG,
        stiffness_n_per_m=stiffness_n_per_m,
        damping_ratio=ALTERNATE_NET_DAMPING,
        damping="net",
        environment_n_per_m=SOFT_ESTIMATE_N_PER_M,
        formulation=formulation,
    )
    words = {"setpoint": "Proposed", "measured": "Alternate"}[formulation]
    return Experiment(
        name=name,
        alias=alias,
        title=f"{words} formulation, prolonged force control, k = {stiffness_n_per_m:g} N/m",
        source="thesis sections 6.2.2 and 9.3.3; the trial is this rig's",
        duration_s=claims7.END_S,
        plant=plate(SOFT_N_PER_M, PRELOAD_N),
        controller=ControllerConfig(impedance=impedance),
        reference=REFERENCE,
        claims=claims6.CLAIMS[name],
    )


def free_space() -> Experiment:
    """The alternate formulation with nothing to touch and nothing to do: k = 500 N/m."""
    name, touching = "alternate-free-space", prolonged("measured", "alternate-k500", "measured-k500", 500.0)
    return touching._replace(
        name=name,
        alias="measured-free-space",
        title="Alternate formulation, standing in free space, k = 500 N/m",
        plant=sampled(Environment()),
        reference=(),
        claims=claims6.CLAIMS[name],
    )


EXPERIMENTS = (
    equivalence("6-6", "impedance", 50.0),
    equivalence("6-7", "explicit", 50.0),
    equivalence("6-8", "impedance", 500.0),
    equivalence("6-9", "explicit", 500.0),
    equivalence("6-10", "impedance", 5000.0),
    equivalence("6-11", "explicit", 5000.0),
    prolonged("measured", "alternate-k50", "measured-k50", 50.0),
    prolonged("measured", "alternate-k500", "measured-k500", 500.0),
    prolonged("measured", "alternate-k5000", "measured-k5000", 5000.0),
    prolonged("measured", "alternate-k50000", "measured-k50000", 50e3),
    free_space(),
    prolonged("setpoint", "proposed-k50000", "setpoint-k50000", 50e3),
)
PAIRS = claims6.PAIRS
