"""Builds a plant's description, and checks one that is received as strictly as a configuration."""

from typing import Any

from hydrohil.shared.contract.messages import PlantDescription
from hydrohil.shared.machine.description import MachineDescription, machine_hash
from hydrohil.shared.machine.validation import machine_problem
from hydrohil.shared.units import NS_PER_S

LONGEST_PERIOD_NS = NS_PER_S
LONGEST_LEASE_NS = 10 * NS_PER_S
MOST_FORCE_N = 1e6
AXES = (0, 1, 2)


def described(machine: MachineDescription, **rest: Any) -> PlantDescription:
    """The description of a plant with this machine; `rest` are the fields that follow its hash, by name."""
    return PlantDescription(machine=machine, machine_hash=machine_hash(machine), **rest)


def description_problem(description: PlantDescription) -> str:
    """Why a description cannot be used, in one line; "" if it can."""
    machine, digest, period_ns, latch_ns, permit_ttl_ns, command_ttl_ns, force_limit_n, axis, sign = description
    if what := machine_problem(machine):
        return what
    if digest != machine_hash(machine):
        return f"machine_hash is {digest.hex()[:16]}; expected {machine_hash(machine).hex()[:16]}, the hash of its machine"
    if not (0 < period_ns <= LONGEST_PERIOD_NS and 0 <= latch_ns <= period_ns):
        return (
            f"samples are {period_ns} ns apart and the latch {latch_ns} ns later; expected 1..{LONGEST_PERIOD_NS}, latch within"
        )
    if not (0 <= permit_ttl_ns <= LONGEST_LEASE_NS and 0 <= command_ttl_ns <= LONGEST_LEASE_NS):
        return f"the leases are {permit_ttl_ns} and {command_ttl_ns} ns; expected 0..{LONGEST_LEASE_NS}"
    if not 0.0 < force_limit_n <= MOST_FORCE_N:
        return f"gate_force_limit_n is {force_limit_n:g} N; expected above 0, at most {MOST_FORCE_N:g}"
    if axis not in AXES or sign not in (-1.0, 1.0):
        return f"force_axis is {axis} and force_sign {sign:g}; expected an axis 0..2 and a sign -1 or 1"
    return ""
