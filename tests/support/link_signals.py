"""What a law reads, for a test that names only what it is about."""

from hydrohil.services.controller.laws.law import LinkSignals


def signals(q, q_set, qd, qd_set, dt_s=0.0045, load_tau=0.0, held_a=0.0):
    """Signals of a link whose law acts and does not begin."""
    return LinkSignals(
        acting=1, takes_over=0, held_a=held_a, q=q, q_set=q_set, qd=qd, qd_set=qd_set, load_tau=load_tau, dt_s=dt_s
    )
