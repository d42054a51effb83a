"""What all services must agree on before the supervisor arms."""

from typing import NamedTuple

from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.services.supervisor.params import below_gate
from hydrohil.shared.contract.codec import Header
from hydrohil.shared.contract.envelope import Envelope
from hydrohil.shared.contract.messages import PlantDescription
from hydrohil.shared.transport.bus import Run, same_run


class Declared(NamedTuple):
    """What each has loaded or said, as far as it is known."""

    envelope: Envelope | None
    config: SupervisorConfig
    description: PlantDescription | None
    run: Run
    plant: Header  # of the sample that is judged
    controller: Header | None  # of its newest state
    described: Header | None  # of the plant's newest description
    machine_id: int  # of the machine in it
    driven_id: int  # of the machine that the controller states it drives
    beyond_qualified: str  # why the rate is above what this host is qualified for, "" if it is not


def prearm_problem(declared: Declared) -> str:
    """Which condition does not hold and what to do, in one line; "" if all agree."""
    envelope, config, description, run, plant, controller, described, machine_id, driven_id, beyond_qualified = declared
    if envelope is None:
        return "no experiment is loaded (`hydrohil run NAME` loads one)"
    if controller is None:
        return "no controller has answered a sample: start it (`hydrohil controller`)"
    if description is None or not description.permit_ttl_ns > 0:
        return "the plant still measures this host to choose its lease: wait two seconds"
    if not below_gate(config, description):
        return f"force limit, bias and noise do not stay below the gate's {description.gate_force_limit_n:g} N"
    for name, header in (("plant", plant), ("controller", controller)):
        if not same_run(header, run):
            return f"the {name} has another experiment or run loaded: load again"
    if described is None or not same_run(described, run):
        return "the plant has not described its machine since the load: wait a second, then arm again"
    if described.epoch != plant.epoch:
        return "the machine was described by another process than the plant that samples: end the other one, restart this cell"
    if driven_id != machine_id:
        plant_s = f"{description.machine.name}, {machine_id:012x}"
        return f"the controller drives another machine ({driven_id:012x}) than the plant describes ({plant_s}): load again"
    return beyond_qualified
