"""What an experiment says that the tool will meet, as far as the controller's checks before a trial need to know it."""

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

AXIS_X, AXIS_Z = 0, 2


class ContactEnvironment(NamedTuple):
    """The environment along the gauge's axis."""

    kind: Literal["free", "plate", "crate"]
    stiffness_n_per_m: float  # k_eff, of gauge and plate in series; the gauge's alone at a crate that stands; 0 in free space
    force_axis: int
    force_sign: float  # direction of the environment's push
    surface_m: float  # on that axis


def contact_environment(plant: Mapping[str, Any]) -> ContactEnvironment:
    """What the experiment's section [plant] says; raises KeyError or TypeError where it does not say it."""
    environment = plant["environment"]
    kind, gauge = environment["kind"], plant["machine"]["sensor_stiffness_n_per_m"]
    if kind == "crate":
        return ContactEnvironment(kind, gauge, AXIS_X, -1.0, environment["surface_m"])
    if kind == "plate":
        stiffness = environment["stiffness_n_per_m"]
        return ContactEnvironment(kind, stiffness * gauge / (stiffness + gauge), AXIS_Z, 1.0, environment["surface_m"])
    return ContactEnvironment("free", 0.0, AXIS_Z, 1.0, environment["surface_m"])


def resting_m(met: ContactEnvironment, start_m: float, nominal_m: float, push_n: float, stiffness_n_per_m: float) -> float:
    """Where a target of k comes to rest on the gauge's axis, pressed by `push_n`; the force at the start was taken for zero.

    k (x - x_d) = sign (f - push) , f = k_eff times the depth; a crate is taken to slide: it holds nothing.
    """
    k, k_eff = stiffness_n_per_m, met.stiffness_n_per_m
    if met.kind != "plate":
        return nominal_m - met.force_sign * push_n / k
    tared_n = k_eff * max(0.0, met.surface_m - start_m)
    free_m = nominal_m - (tared_n + push_n) / k
    if free_m >= met.surface_m:
        return free_m
    return (k * nominal_m + k_eff * met.surface_m - tared_n - push_n) / (k + k_eff)
