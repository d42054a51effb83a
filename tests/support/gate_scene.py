"""A gate that everything permits to open, and the one thing changed in each test."""

from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.gate import CommandObservation, GateInput, GateMemory, PermitObservation, gate_step
from hydrohil.shared.contract.messages import Mode

ARMING_ID, OTHER = 77, 78
SUPERVISOR, CONTROLLER = 11, 22  # epochs
ZERO = (2048, 2048, 2048)
TTL = 20_000_000
LIMITS = GateLimits()
NO_SIGNS = (0, 0, 0)

PERMIT = PermitObservation(True, ARMING_ID, SUPERVISOR, int(Mode.RUNNING), 4_000_000, NO_SIGNS)
COMMAND = CommandObservation(True, ARMING_ID, CONTROLLER, 4_000_000, 100, ZERO)
FINE = GateInput(
    permit=PERMIT,
    command=COMMAND,
    force_counts=10,
    force_n=13.5,
    tick=0,
    estop=False,
    overrun=False,
    link_faults=0,
    epoch_conflicts=0,
)
UNLOAD_UP = PERMIT._replace(mode=int(Mode.RECOVER), recover_signs=(0, -1, 0))


def permit(**changes):
    return FINE._replace(permit=PERMIT._replace(**changes))


def command(**changes):
    return FINE._replace(command=COMMAND._replace(**changes))


def codes(*values):
    return command(codes=values)


def armed_anew(arming_id, **changes):
    """Both messages carry another arming."""
    return FINE._replace(permit=PERMIT._replace(arming_id=arming_id), command=COMMAND._replace(arming_id=arming_id), **changes)


def step(memory, observed, limits=LIMITS, at_latch=True):
    return gate_step(memory, limits, observed, at_latch)


def opened(samples=1, limits=LIMITS):
    memory = GateMemory()
    for _ in range(samples):
        memory = step(memory, FINE, limits)
    return memory


def recovering(*values):
    return FINE._replace(permit=UNLOAD_UP, command=COMMAND._replace(codes=values), tick=-(2**31), force_n=600.0)
