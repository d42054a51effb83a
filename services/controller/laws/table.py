"""All laws, one row each. A law's number in the kernels is its place here: a new law is a file, and a row at the end."""

import math
from collections.abc import Callable

from hydrohil.services.controller.laws.deadband import DEADBAND
from hydrohil.services.controller.laws.final import FINAL
from hydrohil.services.controller.laws.hysteresis import HYSTERESIS
from hydrohil.services.controller.laws.law import FeedbackPart, Law, LawAnswer, LawStep, LinkLawState, LinkSignals
from hydrohil.services.controller.laws.morse import MORSE
from hydrohil.services.controller.laws.parts import next_state, position_error
from hydrohil.services.controller.laws.pi import PI
from hydrohil.services.controller.laws.robust import ROBUST
from hydrohil.services.controller.laws.torque import TORQUE
from hydrohil.services.controller.laws.vetia import VETIA
from hydrohil.services.controller.params import LinkGains
from hydrohil.shared.compiled.kernel import kernel

NumberedStep = Callable[[int, LinkLawState, LinkGains, LinkSignals], LawAnswer]
NumberedPart = Callable[[int, LinkLawState, LinkGains, LinkSignals, float], tuple[float, int]]

LAWS: tuple[Law, ...] = (PI, MORSE, DEADBAND, HYSTERESIS, VETIA, FINAL, ROBUST, TORQUE)
LAW_NAMES = tuple(law.name for law in LAWS)


def law_number(name: str) -> int:
    """The kernels' number of the law `name`."""
    return LAW_NAMES.index(name)


def fold(laws: tuple[Law, ...]) -> tuple[NumberedStep, NumberedPart]:
    """Two kernels of all rows: step and feedback part of the law with the number that they are called with."""
    step: NumberedStep = _no_step
    part: NumberedPart = _no_part
    for number, law in reversed([*enumerate(laws)]):
        step, part = _step_before(number, law.step, step), _part_before(number, law.feedback_part, part)
    return step, part


@kernel
def _no_step(law: int, state: LinkLawState, gains: LinkGains, signals: LinkSignals) -> LawAnswer:
    return state, math.nan, 0  # no row has this number: what is not finite becomes the code of zero current


@kernel
def _no_part(law: int, state: LinkLawState, gains: LinkGains, signals: LinkSignals, current_a: float) -> tuple[float, int]:
    return math.nan, state.relay


def _step_before(number: int, step: LawStep, rest: NumberedStep) -> NumberedStep:
    @kernel
    def step_of(law: int, state: LinkLawState, gains: LinkGains, signals: LinkSignals) -> LawAnswer:
        if law == number:
            return step(state, gains, signals)
        return rest(law, state, gains, signals)

    return step_of


def _part_before(number: int, part: FeedbackPart, rest: NumberedPart) -> NumberedPart:
    @kernel
    def part_of(law: int, state: LinkLawState, gains: LinkGains, signals: LinkSignals, current_a: float) -> tuple[float, int]:
        if law == number:
            return part(state, gains, signals, current_a)
        return rest(law, state, gains, signals, current_a)

    return part_of


law_step, feedback_part = fold(LAWS)


@kernel
def take_over(law: int, state: LinkLawState, gains: LinkGains, signals: LinkSignals) -> LinkLawState:
    """A law that begins, or has other gains, where the valve has the current `held_a`: I so that the law gives just that.

    Bumpless transfer: the state of the new controller is set so that its output is what the actuator really has (Hanus,
    Kinnaert, Henrotte 1987, conditioning); for other gains it keeps P + I (Astrom, Hagglund 1995, bumpless parameter changes).
    """
    feedback_a, relay = feedback_part(law, state, gains, signals, signals.held_a)
    integral_a = feedback_a - gains.kp_a_per_q * position_error(gains, signals)
    return next_state(state, signals, integral_a, state.boost_armed, relay)
