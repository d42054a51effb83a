"""Chapter 7 of the thesis: static force control held for long, where the target stiffness decides on limit cycles.

The trials of chapter 6 prolonged: 100 N on the soft plate from light contact, the up/down link alone, no set-point
compensation, but the final law. The text states no duration. Four minutes, because a link that by chance comes to rest
with the force almost right leaves the dead zone at (f - f_d) / c, which may take two minutes.
"""

from hydrohil.claims.pairs import PairClaim
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import ControllerConfig, ImpedanceConfig, Segment
from hydrohil.thesis import claims7
from hydrohil.thesis.chapter5 import DOWN_UP_ALONE, FORCE_STEP_N, PRELOAD_N, SOFT_ESTIMATE_N_PER_M, SOFT_N_PER_M, STEP_S, plate


def prolonged(figure: str, alias: str, words: str, mass_kg: float, stiffness_n_per_m: float, damping_ratio: float) -> Experiment:
    """100 N on the soft plate for four minutes (7.2)."""
    name = f"fig-{figure}"
    impedance = ImpedanceConfig(
        mass_kg=mass_kg,
        stiffness_n_per_m=stiffness_n_per_m,
        damping_ratio=damping_ratio,
        damping="net",
        environment_n_per_m=SOFT_ESTIMATE_N_PER_M,
    )
    return Experiment(
        name=name,
        alias=f"prolonged-force-{alias}",
        title=f"Prolonged static force control, {words}",
        source=f"thesis figure {figure}, section 7.2",
        duration_s=claims7.END_S,
        plant=plate(SOFT_N_PER_M, PRELOAD_N),
        controller=ControllerConfig(acting=DOWN_UP_ALONE, impedance=impedance),
        reference=(Segment("force", "step", STEP_S, amount=FORCE_STEP_N),),
        claims=claims7.CLAIMS[name],
    )


EXPERIMENTS = (
    prolonged("7-1", "50", "k = 50 N/m", 500.0, 50.0, 5.0),
    prolonged("7-2", "500", "k = 500 N/m", 500.0, 500.0, 5.0),
    prolonged("7-3", "5000", "k = 5 kN/m", 500.0, 5e3, 2.0),
    prolonged("7-4", "50000", "k = 50 kN/m", 500.0, 50e3, 0.3),
    prolonged("7-5", "heavy", "m = 50 t, k = 50 N/m", 50e3, 50.0, 1.2),
    prolonged("7-6", "light", "m = 50 kg, k = 50 kN/m", 50.0, 50e3, 1.2),
)
PAIRS: tuple[PairClaim, ...] = claims7.PAIRS
