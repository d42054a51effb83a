"""Where the tool's tip is, for joint positions of a simulated arm."""

from hydrohil.claims.trace import Reals
from hydrohil.services.plant.mechanism import Triple, posture, tip
from hydrohil.services.plant.params import MachineParams


def tips_m(machine: MachineParams, q: Reals) -> list[Triple]:
    """x, y, z of the tip in m for each row of `q`, (n, 3) in rad, rad and m."""
    return [tip(posture(machine, (float(q1), float(q2), float(q3)))) for q1, q2, q3 in q]
