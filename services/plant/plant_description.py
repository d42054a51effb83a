"""What the plant tells of itself: channel tables, periods, leases, the gate's limit."""

from hydrohil.services.plant.config import GateLimits, PlantConfig, latch_substeps
from hydrohil.services.plant.params import contact_params
from hydrohil.shared.contract.converters import UNIMATE_CONVERTERS, UNIMATE_ENCODERS, UNIMATE_FORCE
from hydrohil.shared.contract.messages import PlantDescription
from hydrohil.shared.units import SUBSTEP_NS


def describe(config: PlantConfig, limits: GateLimits) -> PlantDescription:
    """The description that a controller of this machine needs."""
    contact = contact_params(config.environment)
    return PlantDescription(
        "Unimate MKII-2000",
        UNIMATE_ENCODERS,
        UNIMATE_FORCE,
        UNIMATE_CONVERTERS,
        config.sample_period_substeps * SUBSTEP_NS,
        latch_substeps(config) * SUBSTEP_NS,
        limits.permit_ttl_ns,
        limits.command_ttl_ns,
        limits.force_limit_n,
        contact.force_axis,
        contact.force_sign,
    )
