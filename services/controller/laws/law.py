"""What a control law of one link is: what it reads, what it carries on, and the row by which it is found.

The integral is kept as current: I here is K_I I of the thesis. Positive is down and out. The suffixes `q` and `tau` are those of
`shared/units.py`.
"""

from collections.abc import Callable
from typing import NamedTuple

from hydrohil.services.controller.params import LinkGains
from hydrohil.shared.compiled.kernel import kernel


class LinkSignals(NamedTuple):
    """What one link's law reads at one sample."""

    acting: int  # 1 = the law drives the valve
    takes_over: int  # 1 = law or gains are others than at the sample before
    held_a: float  # current of the code that the D/A holds
    q: float
    q_set: float
    qd: float
    qd_set: float
    load_tau: float  # that the environment puts on the link
    dt_s: float


class LinkLawState(NamedTuple):
    """What one link's law carries from sample to sample; a law that takes over finds it all."""

    integral_a: float = 0.0
    boost_armed: int = 1  # 0 = this stiction event has had its boost
    qd_set: float = 0.0  # of the last sample, for the braking acceleration
    relay: int = 0  # sign of the hysteretic compensation
    peak_q_per_s: float = 0.0  # largest set-point speed since it last stood or turned round


AT_REST = LinkLawState()
LawAnswer = tuple[LinkLawState, float, int]  # state, current in A, 1 if the integral was boosted
LawStep = Callable[[LinkLawState, LinkGains, LinkSignals], LawAnswer]
FeedbackPart = Callable[[LinkLawState, LinkGains, LinkSignals, float], tuple[float, int]]


@kernel
def all_feedback(state: LinkLawState, gains: LinkGains, signals: LinkSignals, current_a: float) -> tuple[float, int]:
    """K_P e + I of a law that adds nothing to it."""
    return current_a, state.relay


class Law(NamedTuple):
    """One row of the table of laws; both functions are kernels."""

    name: str
    step: LawStep  # answers one sample
    feedback_part: FeedbackPart = all_feedback  # (K_P e + I, the relay's sign) with which the law gives a current
