"""From the position laws to the D/A: what each link's law answers, and the codes inside the slew limit in force."""

import math
from typing import NamedTuple

from hydrohil.services.controller.laws.law import AT_REST, LinkLawState, LinkSignals
from hydrohil.services.controller.laws.table import law_step, take_over
from hydrohil.services.controller.params import ControllerParams, LinkGains
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.converters import code_to_current, current_to_code
from hydrohil.shared.contract.messages import GateState, Sample
from hydrohil.shared.machine.description import Drive, Triple

GATE_RECOVERING = int(GateState.RECOVERING)

Codes = tuple[int, int, int]
Laws = tuple[LinkLawState, LinkLawState, LinkLawState]
LAWS_AT_REST = (AT_REST, AT_REST, AT_REST)


class Handover(NamedTuple):
    """What a change of parameters leaves to the samples that follow it."""

    links: tuple[int, int, int] = (0, 0, 0)  # 1 = law or gains of the link are others from the next sample on
    tight_until: int = 0  # number of the first sample at which its tight slew limit holds no more


NOTHING_CHANGED = Handover()


class JointMotion(NamedTuple):
    """Positions, velocities and loads of the links at one sample."""

    q: Triple
    q_set: Triple
    qd: Triple
    qd_set: Triple
    load_tau: Triple


class Actuation(NamedTuple):
    """What the laws make of one sample."""

    laws: Laws
    current_a: Triple
    boosted: tuple[int, int, int]
    codes: Codes


@kernel
def slewed_code(drive: Drive, current_a: float, accepted: int, limit: int) -> int:
    """Code for `current_a`, at most `limit` from the code that the gate last accepted; at once zero if it is not finite."""
    if not abs(current_a) < math.inf:
        return drive.zero_code
    code = current_to_code(drive, current_a)
    if code > accepted + limit:
        return accepted + limit
    if code < accepted - limit:
        return accepted - limit
    return code


@kernel
def shaped_codes(params: ControllerParams, current_a: Triple, sample: Sample, tight_until: int) -> Codes:
    """Codes inside the slew limit in force: the tight one until `tight_until` and for the first samples after the gate opened."""
    limit, opened = params.slew_codes, sample.gate_open_samples
    if (opened < params.tight_samples or sample.number < tight_until) and params.tight_slew_codes < limit:
        limit = params.tight_slew_codes
    accepted = sample.dac_counts
    return (
        slewed_code(params.drive, current_a[0], accepted[0], limit),
        slewed_code(params.drive, current_a[1], accepted[1], limit),
        slewed_code(params.drive, current_a[2], accepted[2], limit),
    )


@kernel
def link_signals(
    params: ControllerParams, handover: Handover, sample: Sample, motion: JointMotion, link: int, dt_s: float
) -> LinkSignals:
    """What the law of one link reads."""
    return LinkSignals(
        acting=params.acting[link],
        takes_over=handover.links[link],
        held_a=code_to_current(params.drive, sample.dac_counts[link]),
        q=motion.q[link],
        q_set=motion.q_set[link],
        qd=motion.qd[link],
        qd_set=motion.qd_set[link],
        load_tau=motion.load_tau[link],
        dt_s=dt_s,
    )


@kernel
def link_step(law: int, state: LinkLawState, gains: LinkGains, signals: LinkSignals) -> tuple[LinkLawState, float, int]:
    """Answer of one link's law; a link that does not act gets no current, and its law integrates nothing.

    A law that takes over keeps the current that the valve has for this one sample.
    """
    if signals.acting == 0:
        return AT_REST, 0.0, 0
    if signals.takes_over != 0:
        return take_over(law, state, gains, signals), signals.held_a, 0
    return law_step(law, state, gains, signals)


@kernel
def apply_laws(
    params: ControllerParams, laws: Laws, handover: Handover, sample: Sample, motion: JointMotion, dt_s: float
) -> Actuation:
    """Answer of the three links' position laws."""
    law, gains = params.law, params.gains
    law_1, u_1, boosted_1 = link_step(law, laws[0], gains[0], link_signals(params, handover, sample, motion, 0, dt_s))
    law_2, u_2, boosted_2 = link_step(law, laws[1], gains[1], link_signals(params, handover, sample, motion, 1, dt_s))
    law_3, u_3, boosted_3 = link_step(law, laws[2], gains[2], link_signals(params, handover, sample, motion, 2, dt_s))
    current_a, boosted = (u_1, u_2, u_3), (boosted_1, boosted_2, boosted_3)
    return Actuation((law_1, law_2, law_3), current_a, boosted, shaped_codes(params, current_a, sample, handover.tight_until))


@kernel
def unload(params: ControllerParams, sample: Sample) -> Actuation:
    """Constant low current with the signs that a recovering gate allows; nothing from any other gate."""
    if sample.gate != GATE_RECOVERING:
        zero = params.drive.zero_code
        return Actuation(LAWS_AT_REST, (0.0, 0.0, 0.0), (0, 0, 0), (zero, zero, zero))
    u, signs = params.recover_current_a, sample.recover_signs
    current_a = (u[0] * signs[0], u[1] * signs[1], u[2] * signs[2])
    return Actuation(LAWS_AT_REST, current_a, (0, 0, 0), shaped_codes(params, current_a, sample, NOTHING_CHANGED.tight_until))
