"""Tuned gains beside those of Table 2 (or of the experiment, on another plant), and why they differ, from the evidence."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from hydrohil.experiment.sections import UNIMATE_GAINS, UNIMATE_PARAMS, LinkGains, PlantConfig
from hydrohil.shared.units import A_PER_MA
from hydrohil.tuning.bench import Criteria, Step, a_per_printed, rad_per_unit, unit
from hydrohil.tuning.procedure import LinkTuning

TABLE_2 = "Table 2"
BEFORE = "before"
DOWN_UP = 1
FLAT = 1.15  # an error within this of the least makes no optimum that one would find by hand


class Compared(NamedTuple):
    """One gain in the unit in which Table 2 prints it."""

    gain: str
    unit: str
    tuned: float
    reference: float
    why: str

    @property
    def ratio(self) -> float:
        """Tuned over reference."""
        return self.tuned / self.reference if self.reference > 0.0 else math.nan


def reference(plant: PlantConfig, gains: tuple[LinkGains, LinkGains, LinkGains]) -> tuple[str, tuple[LinkGains, ...]]:
    """Name and gains of what the tuned ones are set against: Table 2 on the Unimate, else what the experiment had."""
    return (TABLE_2, UNIMATE_GAINS) if plant.machine == UNIMATE_PARAMS else (BEFORE, gains)


def compare(tuning: LinkTuning, name: str, given: LinkGains, criteria: Criteria) -> tuple[Compared, ...]:
    """One row a gain that the steps have found."""
    if tuning.gains is None:
        return ()
    link, tuned, by_number = tuning.link, tuning.gains, {step.number: step for step in tuning.steps}
    printed, scale, u = a_per_printed(link), rad_per_unit(link), unit(link)

    def row(gain: str, unit_: str, field: str, factor: float, why: Callable[[float], str]) -> Compared:
        of_given = getattr(given, field) / factor
        return Compared(gain=gain, unit=unit_, tuned=getattr(tuned, field) / factor, reference=of_given, why=why(of_given))

    return (
        row("K_P", f"mA/{u}", "kp_a_per_q", printed, lambda was: why_proportional(by_number[1], was, name, criteria)),
        row("K_I of PI", f"mA/({u} s)", "linear_ki_a_per_q_s", printed, lambda was: why_linear(by_number[2], was, name, link)),
        row("K_I", f"mA/({u} s)", "ki_a_per_q_s", printed, lambda was: why_integral(by_number[3], was, name)),
        row("alpha_max", f"{u}2/s2", "alpha_max_q2_per_s2", scale * scale, lambda was: why_alpha(by_number[4], was, name)),
        row("U down or out", "mA", "boost_positive_a", A_PER_MA, lambda _: why_threshold(by_number[5], 1)),
        row("U up or in", "mA", "boost_negative_a", A_PER_MA, lambda _: why_threshold(by_number[5], -1)),
        row("K_a", f"mA s/{u}", "ka_a_s_per_q", printed, lambda was: why_braking(by_number[6], was, name)),
    )


def column(step: Step, number: int) -> list[float]:
    """One column of a step's evidence as numbers."""
    return [float(row[number]) for row in step.rows]


def at(step: Step, number: int, value: float) -> float:
    """A column of the evidence where the first is `value`, between rows."""
    return float(np.interp(value, column(step, 0), column(step, number)))


def why_proportional(step: Step, was: float, name: str, criteria: Criteria) -> str:
    """How far both stay below the ringing."""
    limit = max(float(row[0]) for row in step.rows if row[-1] == "yes")
    return f"ringing lasts above {limit:.4g}: {name} stays {limit / was:.2f} below it, this rule {criteria.margin:g}"


def why_linear(step: Step, was: float, name: str, link: int) -> str:
    """What wind-up the other value gives."""
    printed = "" if link == DOWN_UP or name != TABLE_2 else " (not printed, a tenth of K_I)"
    tried = column(step, 0)
    if not tried[0] <= was <= tried[-1]:
        return f"wind-up decides; {was:.4g}{printed} was not reached"
    return f"wind-up decides: at {was:.4g}{printed} it is {at(step, 1, was):.0%} of the step"


def why_integral(step: Step, was: float, name: str) -> str:
    """What sets the limit, and what the other value gives."""
    tried, limit = column(step, 0), step.decision.partition(": ")[2]
    if not tried[0] <= was <= tried[-1]:
        return limit
    return f"{limit}; with {name}'s K_I the sine swings {at(step, 6, was):.2f}, the ramp's error is {at(step, 1, was):.3g}"


def why_alpha(step: Step, was: float, name: str) -> str:
    """How flat the error is between both."""
    if not min(column(step, 0)) <= was <= max(column(step, 0)):
        return f"{name}'s alpha lies outside what was tried"
    least = min(value for value, row in zip(column(step, 1), step.rows, strict=True) if row[-1] == "yes")
    return f"{above_least(at(step, 1, was) / least)} with {name}'s alpha"


def above_least(ratio: float) -> str:
    """An error relative to the least one, as a phrase."""
    return f"{'no sharp optimum: ' if ratio <= FLAT else ''}the error is {ratio - 1.0:.0%} above the least"


def why_threshold(step: Step, direction: int) -> str:
    """What a faster current makes of it."""
    *slow, fast = [row for row in step.rows if row[2] == f"{direction:+d}"]
    currents = [float(row[3]) for row in slow]
    return (
        f"{min(currents):.1f} to {max(currents):.1f} over the positions at {slow[0][1]:g} mA/s, {fast[3]:.1f} at {fast[1]:g}: "
        "how fast the current rose, the text does not say"
    )


def why_braking(step: Step, was: float, name: str) -> str:
    """What the other value costs."""
    if was > max(column(step, 0)):
        return f"{name}'s K_a lies outside what was tried"
    return f"{above_least(at(step, 3, was) / min(column(step, 3)))} with {name}'s K_a"
