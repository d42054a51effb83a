"""Descriptions of plants, as controller, supervisor and recorder get them."""

from hydrohil.shared.contract.description import described
from hydrohil.shared.contract.messages import PlantDescription
from hydrohil.shared.machine.unimate import UNIMATE

PERIOD_NS, LATCH_NS, LEASE_NS = 4_500_000, 4_000_000, 20_000_000


def description(machine=UNIMATE, period_ns=PERIOD_NS, force_axis=0, force_sign=-1.0, lease_ns=LEASE_NS) -> PlantDescription:
    return described(
        machine,
        sample_period_ns=period_ns,
        latch_ns=min(LATCH_NS, period_ns),
        permit_ttl_ns=lease_ns,
        command_ttl_ns=lease_ns,
        gate_force_limit_n=420.0,
        force_axis=force_axis,
        force_sign=force_sign,
    )
