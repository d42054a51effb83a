"""Beyond the thesis: the final law with the load of the environment fed forward (thesis 9.2.2)."""

from hydrohil.services.controller.laws.final import final_step
from hydrohil.services.controller.laws.law import Law, LawAnswer, LinkLawState, LinkSignals
from hydrohil.services.controller.params import LinkGains
from hydrohil.shared.compiled.kernel import kernel


@kernel
def load_feedforward(gains: LinkGains, load_tau: float) -> float:
    """-k_tau tau: current against the load tau = J^T f that the environment puts on the link, positive down and out (9.2.2)."""
    return -gains.load_feedforward_a_per_tau * load_tau


@kernel
def torque_step(state: LinkLawState, gains: LinkGains, signals: LinkSignals) -> LawAnswer:
    """The final law, and the feed-forward behind it.

    So a boost breaks away from what the load leaves to overcome, which is less where the load aids the motion.
    """
    after, current_a, boosted = final_step(state, gains, signals)
    return after, current_a + load_feedforward(gains, signals.load_tau), boosted


@kernel
def before_feedforward(state: LinkLawState, gains: LinkGains, signals: LinkSignals, current_a: float) -> tuple[float, int]:
    """K_P e + I with which the law gives `current_a`."""
    return current_a - load_feedforward(gains, signals.load_tau), state.relay


TORQUE = Law("torque", torque_step, before_feedforward)
