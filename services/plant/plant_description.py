"""What the plant says of itself, derived from its configuration: the machine that is named there, as it is configured."""

from hydrohil.services.plant.config import GateLimits, PlantConfig, latch_substeps
from hydrohil.services.plant.params import PA_PER_MPA, MachineParams, contact_params
from hydrohil.shared.contract.configured_machine import gauge, geometry
from hydrohil.shared.contract.description import described, description_problem
from hydrohil.shared.contract.link_units import plain_of
from hydrohil.shared.contract.messages import PlantDescription
from hydrohil.shared.machine.description import LINK_UNITS, LINKS, MachineDescription
from hydrohil.shared.machine.unimate import MACHINES
from hydrohil.shared.units import SUBSTEP_NS

GAUGE_FACTOR = 2.0  # a stiffer gauge loosens the rules on jumps and drift of the force, which no experiment may switch off


def describe(config: PlantConfig, limits: GateLimits) -> PlantDescription:
    """The description of this plant. Raises ValueError with one line where there is no such machine, or it cannot be."""
    contact = contact_params(config.environment)
    description = described(
        machine_description(config),
        sample_period_ns=config.sample_period_substeps * SUBSTEP_NS,
        latch_ns=latch_substeps(config) * SUBSTEP_NS,
        permit_ttl_ns=limits.permit_ttl_ns,
        command_ttl_ns=limits.command_ttl_ns,
        gate_force_limit_n=float(limits.force_limit_n),
        force_axis=contact.force_axis,
        force_sign=contact.force_sign,
    )
    if what := description_problem(description):
        raise ValueError(f"plant: {what}; correct the machine")
    return description


def machine_description(config: PlantConfig) -> MachineDescription:
    """The named machine with the lengths, travel and gauge that are configured. Raises ValueError with one line."""
    known = MACHINES.get(config.machine_name)
    if known is None:
        raise ValueError(f"plant.machine_name is {config.machine_name!r}; expected one of {', '.join(MACHINES)}")
    _check_supply(config.machine, known)
    _check_gauge(config.machine, known)
    _check_start(config)
    values = plain_of(config.machine)
    return known._replace(geometry=geometry(values), gauge=gauge(values, known.gauge))


def _check_supply(machine: MachineParams, known: MachineDescription) -> None:
    """Raise ValueError where the supply is none of this machine's: its valves, hoses and limits are rated for that."""
    if not known.supply_low_pa <= machine.supply_pressure_pa <= known.supply_high_pa:
        low, high = known.supply_low_pa / PA_PER_MPA, known.supply_high_pa / PA_PER_MPA
        raise ValueError(
            f"plant.machine.supply_pressure_pa is {machine.supply_pressure_pa / PA_PER_MPA:g} MPa; "
            f"expected {low:g}..{high:g} MPa of the machine {known.name}"
        )


def _check_gauge(machine: MachineParams, known: MachineDescription) -> None:
    """Raise ValueError where the gauge is far from the machine's own: its numbers widen the supervisor's rules on force."""
    for name, unit, value, usual in (
        ("sensor_stiffness_n_per_m", "N/m", machine.sensor_stiffness_n_per_m, known.gauge.stiffness_n_per_m),
        ("sensor_damping_ns_per_m", "N s/m", machine.sensor_damping_ns_per_m, known.gauge.damping_ns_per_m),
        ("force_high_n", "N", machine.force_high_n, known.gauge.range_n),
    ):
        if not value <= GAUGE_FACTOR * usual:
            most = f"expected at most {GAUGE_FACTOR * usual:g} {unit}, {GAUGE_FACTOR:g} times that of the machine {known.name}"
            raise ValueError(f"plant.machine.{name} is {value:g} {unit}; {most}")


def _check_start(config: PlantConfig) -> None:
    """Raise ValueError where the machine would start outside the travel of a link."""
    for link, unit, start in zip(LINKS, LINK_UNITS, config.initial_q, strict=True):
        params = getattr(config.machine, link)
        if not params.travel_low_q <= start <= params.travel_high_q:
            travel = f"{params.travel_low_q:g}..{params.travel_high_q:g}"
            raise ValueError(f"plant.initial_q.{link} is {start:g} {unit}; expected inside its travel, {travel}")
