"""Whether a target impedance limit-cycles in prolonged contact: the target's stiffness k against that of plate and gauge, k_eff.

A position loop that cannot place the tool more finely than dx ends, where it corrects an error of alpha dx by beta dx, with
the error  (alpha - 1 - k_eff / k beta) dx , since the force that the motion raises moves the set-point the other way. What
remains must be smaller than dx:  k > k_eff beta / alpha,  alpha and beta between 1 and 2 (thesis 7.1).

dx is not known, but the jump J out of stiction is. Triggered at an error e_t, it leaves  e_t - (1 + k_eff / k) J , which
sets off the next one only beyond the dead zone D of the position law.
"""

from typing import Literal, NamedTuple

Prospect = Literal["cannot", "may", "must"]
PROSPECTS: tuple[Prospect, ...] = ("cannot", "may", "must")
LEAST, MOST = 1.0, 2.0  # alpha and beta lie between (7.1)


class Jump(NamedTuple):
    """How a link leaves stiction, as lengths at the tip; defaults are the Unimate's down/up link at 1 m on the soft plate."""

    jump_m: float = 1.7e-3  # median over the trials of chapter 7
    trigger_m: float = 1.4e-3  # likewise: the error at which the link breaks away
    dead_zone_m: float = 1.05e-3  # 0.06 deg, below which the law ignores an error


def least_stable_n_per_m(k_eff_n_per_m: float, alpha: float = LEAST, beta: float = MOST) -> float:
    """Stiffness k_eff beta / alpha above which an error of alpha corrected by beta dies; by default the worst of them, 2 k_eff.

    Raises ValueError where alpha or beta is not between 1 and 2.
    """
    for name, value in (("alpha", alpha), ("beta", beta)):
        if not LEAST <= value <= MOST:
            raise ValueError(f"{name} is {value:g}: expected {LEAST:g} to {MOST:g} widths of the resolution")
    return k_eff_n_per_m * beta / alpha


def prospect(stiffness_n_per_m: float, k_eff_n_per_m: float) -> Prospect:
    """Whether prolonged contact must (k up to k_eff / 2), may, or cannot (from 2 k_eff on) end in a limit cycle."""
    if stiffness_n_per_m >= least_stable_n_per_m(k_eff_n_per_m):
        return "cannot"
    return "may" if stiffness_n_per_m > least_stable_n_per_m(k_eff_n_per_m, MOST, LEAST) else "must"


def jump_sustains(stiffness_n_per_m: float, k_eff_n_per_m: float, jump: Jump) -> bool:
    """Whether each jump sets off the next:  (1 + k_eff / k) J > e_t + D."""
    return (1.0 + k_eff_n_per_m / stiffness_n_per_m) * jump.jump_m > jump.trigger_m + jump.dead_zone_m
