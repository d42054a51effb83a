"""Position laws beyond the thesis, from its own list of future work: robust overshoot reduction and the torque-aware law.

Only the law differs from the trials that they are set against: those of the final law in chapters 4 and 5.
"""

from hydrohil.claims.pairs import PairClaim
from hydrohil.experiment.experiment import Experiment
from hydrohil.thesis import chapter4, chapter5, claims_position
from hydrohil.thesis.chapter4 import PATTERNS, Pattern


def robust(pattern: Pattern) -> Experiment:
    """A pattern of chapter 4 with braking that takes at least the current which any motion needs (9.2.1)."""
    final, name = chapter4.experiment("final", pattern), f"robust-{pattern}"
    return final._replace(
        name=name,
        alias=name,
        title=final.title.replace("Final position controller", "Robust overshoot reduction"),
        source="beyond the thesis, its section 9.2.1",
        controller=final.controller._replace(law="robust"),
        claims=claims_position.CLAIMS[name],
    )


def torque(final: Experiment) -> Experiment:
    """A force trial of chapter 5 with the joint torques of the measured force fed forward (9.2.2)."""
    name = f"torque-{final.alias}"
    return final._replace(
        name=name,
        alias=name,
        title=f"{final.title}, torque-aware",
        source="beyond the thesis, its section 9.2.2",
        controller=final.controller._replace(law="torque"),
        claims=claims_position.CLAIMS[name],
    )


_FORCE_TRIALS = [trial for trial in chapter5.EXPERIMENTS if trial.name in claims_position.FORCE_FIGURES]
EXPERIMENTS = (*(robust(pattern) for pattern in PATTERNS), *(torque(trial) for trial in _FORCE_TRIALS))
PAIRS: tuple[PairClaim, ...] = claims_position.PAIRS
