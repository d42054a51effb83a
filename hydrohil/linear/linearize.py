"""The linearised closed loop of an experiment and what follows from it, in one call."""

import math
from pathlib import Path
from typing import Any, NamedTuple

from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import Experiment
from hydrohil.linear.closed_loop import Margins, Pole, Steady, is_stable, loop_margins, poles, steady
from hydrohil.linear.linear import DEFAULT_SPOOL_A, LinearModel, OperatingPoint, linear_model
from hydrohil.shared.errors import FileError
from hydrohil.shared.units import A_PER_MA

SHOWN_HZ = (0.01, 30.0)  # of the Bode plots


class Linearization(NamedTuple):
    """The loop of thesis 3.2 at an operating point."""

    experiment: str  # its name
    current_a: float  # spool position as a valve current, at which the orifice is linearised
    stable: bool
    poles: tuple[Pole, ...]  # of the closed loop, slowest first
    loop: Margins  # of 1 + R_F A C M_F + R_X A (C + Q_v)
    valve_loop: Margins  # of the loop broken at the valve's current
    steady: Steady  # gains at rest
    model: LinearModel  # what the transfer functions are made of

    def save_bode(self, path: str | Path) -> None:
        """Write Bode plots of both loops and of what follows the set-points, from 0.01 to 30 Hz. Raises FileError."""
        from hydrohil.linear.bode import save_bode

        try:
            save_bode(self.model, Path(path), f"{self.experiment} at {self.current_a / A_PER_MA:g} mA", SHOWN_HZ)
        except (OSError, ValueError) as error:
            why = getattr(error, "strerror", None) or error
            raise FileError(f"{path}: cannot be written ({why}): name a .png file elsewhere") from None

    def summary(self) -> dict[str, Any]:
        """Everything but the model, for JSON: what `hydrohil linear --json` prints; an infinite number is None."""
        return {
            "experiment": self.experiment,
            "current_ma": self.current_a / A_PER_MA,
            "stable": self.stable,
            "poles": [_finite(pole._asdict()) for pole in self.poles],
            "loop": _finite(self.loop._asdict()),
            "valve_loop": _finite(self.valve_loop._asdict()),
            "steady": _finite(self.steady._asdict()),
        }


def _finite(numbers: dict[str, float]) -> dict[str, float | None]:
    return {name: value if math.isfinite(value) else None for name, value in numbers.items()}


def linearize(experiment: Experiment, *, current_a: float = DEFAULT_SPOOL_A, ideal: bool = False) -> Linearization:
    """Poles, margins and steady-state gains of the linearised closed loop of an impedance experiment (thesis 3.2).

    `current_a` is the spool position as a valve current in A, at which the orifice is linearised; `ideal` leaves delay and
    spool dynamics out, as the thesis does. Dry friction, dead zones and resolution have no place in it: it says nothing about
    sticking and limit cycles. Raises ExperimentError where the experiment has what the model has no term for, or the port is
    shut at that current.
    """
    try:
        model = linear_model(experiment, OperatingPoint(current_a))
    except ValueError as error:
        raise ExperimentError([f"{experiment.name}: {error}"]) from None
    model = model.as_in_the_thesis() if ideal else model
    loop, valve_loop = loop_margins(model)
    return Linearization(
        experiment.name,
        current_a=current_a,
        stable=is_stable(model),
        poles=poles(model),
        loop=loop,
        valve_loop=valve_loop,
        steady=steady(model),
        model=model,
    )
